#include "runtime/core/file_source.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <vector>
#include <fcntl.h>
#include <span>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace coppice {
namespace {

FileSource g_source = nullptr;
void* g_context = nullptr;

Result<int> file_in_memory(const std::string& path, std::span<const std::byte> bytes) {
    const int descriptor = ::memfd_create("coppice", MFD_CLOEXEC);
    while (descriptor >= 0 && !bytes.empty()) {
        const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        bytes = bytes.subspan(size_t(count));
    }
    if (descriptor >= 0 && bytes.empty()) return descriptor;
    const int why = errno;
    if (descriptor >= 0) ::close(descriptor);
    return fail(ErrorId::file_unreadable, path, "", std::strerror(why), "free some memory");
}

// A host's function may throw; what reads files does not.
Result<std::vector<std::byte>> given_by_source(const std::string& path) try {
    return g_source(g_context, path);
} catch (const std::exception& thrown) {
    return fail(ErrorId::file_unreadable, path, "", thrown.what(), "the host's file source threw it");
} catch (...) {
    return fail(ErrorId::file_unreadable, path, "", "unknown", "the host's file source threw it");
}

}  // namespace

void set_file_source(FileSource source, void* context) {
    g_source = source;
    g_context = context;
}

Result<int> open_to_read(const std::string& path) {
    if (g_source) {
        auto given = given_by_source(path);
        if (given) return file_in_memory(path, *given);
        if (given.error().id != ErrorId::file_missing) return fail(std::move(given.error()));
    }
    // Not blocking, so that a pipe is refused below instead of waited for.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        if (errno == ENOENT || errno == ENOTDIR)
            return fail(ErrorId::file_missing, path, "", "no such file", "check the path");
        return fail(ErrorId::file_unreadable, path, "", std::strerror(errno), "check the permissions");
    }
    struct stat info {};
    const bool known = ::fstat(descriptor, &info) == 0;
    const int why = errno;
    if (known && S_ISREG(info.st_mode)) return descriptor;
    ::close(descriptor);
    if (!known) return fail(ErrorId::file_unreadable, path, "", std::strerror(why), "check the disk");
    return fail(ErrorId::file_missing, path, "", "not a regular file", "name a file");
}

}  // namespace coppice
