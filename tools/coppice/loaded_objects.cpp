#include "tools/coppice/loaded_objects.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <link.h>

namespace coppice {
namespace {

// "libfmt.so.9" of "/usr/lib/x86_64-linux-gnu/libfmt.so.9".
std::string_view name_of_file(std::string_view path) { return path.substr(path.rfind('/') + 1); }

bool is_of_system(std::string_view path) {
    constexpr std::string_view k_names[] = {"libc.so.6",       "libm.so.6",           "libdl.so.2",
                                            "libpthread.so.0", "librt.so.1",          "libresolv.so.2",
                                            "libutil.so.1",    "libanl.so.1",         "libmvec.so.1",
                                            "libvulkan.so.1",  "ld-linux-x86-64.so.2"};
    return std::find(std::begin(k_names), std::end(k_names), name_of_file(path)) != std::end(k_names);
}

int add_object(dl_phdr_info* info, size_t, void* context) {
    const std::string_view path = info->dlpi_name ? info->dlpi_name : "";
    // The program has no name here, and what the kernel brings no file.
    if (path.find('/') != std::string_view::npos && !is_of_system(path))
        static_cast<std::vector<std::string>*>(context)->emplace_back(path);
    return 0;
}

}  // namespace

std::vector<std::string> loaded_objects() {
    std::vector<std::string> paths;
    ::dl_iterate_phdr(&add_object, &paths);
    std::error_code error;
    paths.push_back(std::filesystem::read_symlink("/proc/self/exe", error).string());
    std::sort(paths.begin(), paths.end());
    paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
    return paths;
}

bool is_compiler_runtime(const std::string& path) {
    const std::string_view name = name_of_file(path);
    return name == "libstdc++.so.6" || name == "libgcc_s.so.1";
}

}  // namespace coppice
