// Told of every file that is opened to be read: so one learns which files a result came from, whatever their
// formats are.
#pragma once
#include <string>

namespace coppice {

// path: as it was asked for. Called from the threads that open, one at a time.
using FileWatcher = void (*)(void* context, const std::string& path);
struct FileWatching {
    FileWatcher watcher = nullptr;  // nullptr: nobody is told
    void* context = nullptr;
};
// Returns who was told before, for who wants to tell them too, or leave all as it was.
FileWatching set_file_watcher(FileWatcher watcher, void* context);

// For what opens files.
void tell_file_watcher(const std::string& path);

}  // namespace coppice
