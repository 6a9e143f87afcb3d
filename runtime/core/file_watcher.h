// Told of every file that is opened to be read: so one learns which files a result came from, whatever their
// formats are.
#pragma once
#include <string>

namespace coppice {

// path: as it was asked for. Called from the threads that open, one at a time.
using FileWatcher = void (*)(void* context, const std::string& path);
// watcher == nullptr: nobody is told.
void set_file_watcher(FileWatcher watcher, void* context);

// For what opens files.
void tell_file_watcher(const std::string& path);

}  // namespace coppice
