#include "runtime/core/file.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>
#include "runtime/core/mapped_file.h"

namespace coppice {

namespace {

// A new file beside `path`, whose name goes to `temporary`; -1: errno says why. The kernel applies the umask:
// reading it would mean changing it, for all threads.
int create_beside(const std::string& path, std::string& temporary) {
    static std::atomic<uint32_t> count{0};
    int fd = -1;
    for (int attempt = 0; attempt < 1000; ++attempt) {
        temporary = path + "." + std::to_string(::getpid()) + "-" + std::to_string(count++);
        fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || (errno != EEXIST && errno != EINTR))
            break;  // left behind by a process of the same number
    }
    return fd;
}

}  // namespace

Result<std::string> read_text_file(const std::string& path, size_t size_limit_bytes) {
    COPPICE_TRY(MappedFile file, MappedFile::open(path));
    if (file.bytes().size() > size_limit_bytes)
        return fail(ErrorId::limit_exceeded, path, "",
                    "the file has " + std::to_string(file.bytes().size()) + " bytes",
                    "at most " + std::to_string(size_limit_bytes) + " bytes are read");
    return std::string(reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size());
}

Status write_file_pieces(const std::string& path, std::span<const std::span<const std::byte>> pieces) {
    auto failed = [&path](const char* what) {
        return fail(ErrorId::write_failed, path, "", std::string(what) + ": " + std::strerror(errno),
                    "the old file, if any, is unchanged; check space and permissions");
    };
    std::error_code ignored;
    auto parent = std::filesystem::path(path).parent_path();
    if (!parent.empty()) std::filesystem::create_directories(parent, ignored);

    std::string temporary;
    int fd = create_beside(path, temporary);
    if (fd < 0) return failed("cannot create a temporary file");
    auto give_up = [&](const char* what) {
        auto result = failed(what);
        ::close(fd);
        ::unlink(temporary.c_str());
        return result;
    };
    for (std::span<const std::byte> rest : pieces)
        while (!rest.empty()) {
            ssize_t count = ::write(fd, rest.data(), rest.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return give_up("cannot write");
            rest = rest.subspan(size_t(count));
        }
    if (::fsync(fd) != 0) return give_up("cannot flush");
    if (::close(fd) != 0 || ::rename(temporary.c_str(), path.c_str()) != 0) {
        auto result = failed("cannot replace");
        ::unlink(temporary.c_str());
        return result;
    }
    return {};
}

Status write_file(const std::string& path, std::span<const std::byte> bytes) {
    return write_file_pieces(path, std::span(&bytes, 1));
}

Status write_text_file(const std::string& path, std::string_view text) {
    return write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

std::string default_cache_dir() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
        return std::string(cache) + "/coppice";
    if (const char* home = std::getenv("HOME"); home && *home) return std::string(home) + "/.cache/coppice";
    return "/tmp/coppice-cache";
}

std::string program_dir() {
    std::error_code error;
    auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::string(".") : program.parent_path().string();
}

}  // namespace coppice
