#include "runtime/core/file_watcher.h"

#include <mutex>

namespace coppice {
namespace {
std::mutex g_mutex;
FileWatcher g_watcher = nullptr;
void* g_context = nullptr;
}  // namespace

void set_file_watcher(FileWatcher watcher, void* context) {
    std::lock_guard lock(g_mutex);
    g_watcher = watcher;
    g_context = context;
}

void tell_file_watcher(const std::string& path) {
    std::lock_guard lock(g_mutex);
    if (g_watcher) g_watcher(g_context, path);
}

}  // namespace coppice
