#include "tools/coppice/machine.h"

#include <fstream>
#include <thread>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

namespace coppice {
namespace {

// Value of the first line that starts with `key`, without separators and quotes around it.
std::string find_value(const char* file, const std::string& key) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with(key)) continue;
        size_t first = line.find_first_not_of(" \t:=\"", key.size());
        if (first == std::string::npos) return {};
        return line.substr(first, line.find_last_not_of(" \t\"") - first + 1);
    }
    return {};
}

}  // namespace

Machine describe_machine() {
    Machine machine{};
    machine.system = find_value("/etc/os-release", "PRETTY_NAME");
    if (utsname names{}; ::uname(&names) == 0)
        machine.system += std::string(", ") + names.sysname + " " + names.release;
    machine.processor = find_value("/proc/cpuinfo", "model name");
    machine.threads = std::thread::hardware_concurrency();
    long pages = ::sysconf(_SC_PHYS_PAGES), page_bytes = ::sysconf(_SC_PAGE_SIZE);
    if (pages > 0 && page_bytes > 0)
        machine.memory_gib = double(pages) * double(page_bytes) / double(1u << 30);
#if defined(__clang__)
    machine.compiler = "clang " __clang_version__;
#else
    machine.compiler = "gcc " __VERSION__;
#endif
    machine.build = COPPICE_BUILD_TYPE;
    return machine;
}

std::string command_line() {
    std::ifstream stream("/proc/self/cmdline");
    std::string line;
    for (std::string word; std::getline(stream, word, '\0');) {
        if (line.empty()) word = word.substr(word.find_last_of('/') + 1);
        const bool quoted = word.empty() || word.find_first_of(" \t\"$*;&|<>()") != std::string::npos;
        if (!line.empty()) line += ' ';
        line += quoted ? fmt::format("'{}'", word) : word;
    }
    return line;
}

}  // namespace coppice
