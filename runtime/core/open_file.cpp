#include "runtime/core/open_file.h"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include "runtime/core/file_source.h"
#include "runtime/core/file_watcher.h"

namespace coppice {

Result<OpenFile> OpenFile::open(const std::string& path) {
    OpenFile file;
    file.path_ = path;
    COPPICE_TRY(file.descriptor_, open_to_read(path));
    struct stat info {};
    if (::fstat(file.descriptor_, &info) != 0)
        return fail(ErrorId::file_unreadable, path, "", std::strerror(errno), "check the disk");
    file.size_bytes_ = uint64_t(info.st_size);
    tell_file_watcher(path);
    return file;
}

Status OpenFile::read(uint64_t offset_bytes, std::span<std::byte> into) const {
    const std::string place = "byte " + std::to_string(offset_bytes);
    if (offset_bytes > size_bytes_ || into.size() > size_bytes_ - offset_bytes)
        return fail(ErrorId::file_truncated, path_, place, "the file ends before", "make it again");
    while (!into.empty()) {
        const ssize_t count = ::pread(descriptor_, into.data(), into.size(), off_t(offset_bytes));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0)
            return fail(ErrorId::file_unreadable, path_, place, std::strerror(errno), "check the disk");
        if (count == 0)
            return fail(ErrorId::file_truncated, path_, place, "the file has become shorter",
                        "make it again");
        into = into.subspan(size_t(count));
        offset_bytes += uint64_t(count);
    }
    return {};
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)),
      size_bytes_(std::exchange(other.size_bytes_, 0)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(size_bytes_, other.size_bytes_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

OpenFile::~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace coppice
