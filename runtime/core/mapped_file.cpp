#include "runtime/core/mapped_file.h"

#include <cerrno>
#include <cstring>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include "runtime/core/file_source.h"
#include "runtime/core/file_watcher.h"

namespace coppice {

Result<MappedFile> MappedFile::open(const std::string& path) {
    COPPICE_TRY(const int fd, open_to_read(path));
    struct stat info {};
    if (::fstat(fd, &info) != 0) {
        const int stat_errno = errno;
        ::close(fd);
        return fail(ErrorId::file_unreadable, path, "", std::strerror(stat_errno), "check the disk");
    }
    MappedFile file;
    if (info.st_size > 0) {
        void* memory = ::mmap(nullptr, size_t(info.st_size), PROT_READ, MAP_PRIVATE, fd, 0);
        int map_errno = errno;
        ::close(fd);
        if (memory == MAP_FAILED)
            return fail(ErrorId::file_unreadable, path, "", std::strerror(map_errno), "free some memory");
        file.bytes_ = {static_cast<const std::byte*>(memory), size_t(info.st_size)};
    } else {
        ::close(fd);
    }
    tell_file_watcher(path);
    return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace coppice
