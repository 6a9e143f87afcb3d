#include "runtime/core/file_watcher.h"

#include <mutex>
#include <utility>

namespace coppice {
namespace {
std::mutex g_mutex;
FileWatching g_watching;
}  // namespace

FileWatching set_file_watcher(FileWatcher watcher, void* context) {
    std::lock_guard lock(g_mutex);
    return std::exchange(g_watching, {watcher, context});
}

void tell_file_watcher(const std::string& path) {
    std::lock_guard lock(g_mutex);
    if (g_watching.watcher) g_watching.watcher(g_watching.context, path);
}

}  // namespace coppice
