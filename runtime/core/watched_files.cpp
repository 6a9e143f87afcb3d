#include "runtime/core/watched_files.h"

#include <filesystem>
#include "runtime/core/file_watcher.h"

namespace coppice {

WatchedFiles::Stamp WatchedFiles::stamp_of(const std::string& path) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(path, error);
    if (error) return {};
    const uint64_t size_bytes = std::filesystem::file_size(path, error);
    return {written.time_since_epoch().count(), error ? 0 : size_bytes};
}

void WatchedFiles::note(void* context, const std::string& path) {
    static_cast<WatchedFiles*>(context)->stamps_[path] = stamp_of(path);
}

void WatchedFiles::begin() { set_file_watcher(&WatchedFiles::note, this); }
void WatchedFiles::end() { set_file_watcher(nullptr, nullptr); }

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
