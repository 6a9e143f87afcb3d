#include "editor/session/scene_lock.h"

#include <cerrno>
#include <utility>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace coppice {

Result<SceneLock> SceneLock::take(const std::string& scene_path) {
    SceneLock lock;
    lock.path_ = scene_path + ".lock";
    while (true) {
        lock.file_ = ::open(lock.path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (lock.file_ < 0) return lock;
        if (::flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
            const bool busy = errno == EWOULDBLOCK;
            ::close(std::exchange(lock.file_, -1));
            if (!busy) return lock;
            return fail(ErrorId::write_failed, scene_path, "", "another editor has this scene open",
                        "close it there first");
        }
        // Who held it before may have taken the name away since it was opened: then another file has it, or none.
        struct stat held {}, named {};
        if (::fstat(lock.file_, &held) == 0 && ::stat(lock.path_.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
            held.st_dev == named.st_dev)
            return lock;
        ::close(std::exchange(lock.file_, -1));
    }
}

SceneLock& SceneLock::operator=(SceneLock&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    return *this;
}

SceneLock::~SceneLock() {
    if (file_ < 0) return;
    ::unlink(path_.c_str());  // while it is held
    ::close(file_);
}

}  // namespace coppice
