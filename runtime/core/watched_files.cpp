#include "runtime/core/watched_files.h"

#include <filesystem>

namespace coppice {

WatchedFiles::Stamp WatchedFiles::stamp_of(const std::string& path) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(path, error);
    if (error) return {};
    const uint64_t size_bytes = std::filesystem::file_size(path, error);
    return {written.time_since_epoch().count(), error ? 0 : size_bytes};
}

void WatchedFiles::note(void* context, const std::string& path) {
    WatchedFiles& files = *static_cast<WatchedFiles*>(context);
    files.stamps_[path] = stamp_of(path);
    if (files.before_.watcher) files.before_.watcher(files.before_.context, path);
}

// While nothing is opened yet: the watcher of before is known before it is asked for.
void WatchedFiles::begin() {
    before_ = set_file_watcher(nullptr, nullptr);
    set_file_watcher(&WatchedFiles::note, this);
}
void WatchedFiles::end() {
    set_file_watcher(before_.watcher, before_.context);
    before_ = {};
}

bool WatchedFiles::changed() {
    bool any = false;
    for (auto& [path, stamp] : stamps_) {
        const Stamp now = stamp_of(path);
        any = any || now != stamp;
        stamp = now;
    }
    return any;
}

}  // namespace coppice
