// Whether any of the files that something was loaded from has changed since: to load it again while a program runs.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include "runtime/core/file_watcher.h"

namespace coppice {

// From begin to end it is told of every file that is opened (file_watcher.h), and tells who was told before. A file that is written
// to while it is loaded counts as changed, since what is kept of it is from before.
class WatchedFiles {
  public:
    // Beside those from before, so that what could not be loaded is watched as well as what was.
    void begin();
    void end();
    // Of those files one was written to, made or taken away since it was last opened, or since this was last asked; some
    // microseconds a file.
    bool changed();
    size_t size() const { return stamps_.size(); }

  private:
    struct Stamp {
        int64_t written = 0;  // 0: there is no such file
        uint64_t size_bytes = 0;
        bool operator==(const Stamp&) const = default;
    };
    static Stamp stamp_of(const std::string& path);
    static void note(void* context, const std::string& path);
    std::map<std::string, Stamp> stamps_;
    FileWatching before_;
};

}  // namespace coppice
