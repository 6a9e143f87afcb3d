// The files that are opened to be read as long as this lives: what a scene or a plant was made from. Only one
// lives at a time.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include "runtime/core/file_watcher.h"

namespace coppice {

class OpenedFiles {
  public:
    OpenedFiles() { set_file_watcher(&OpenedFiles::add, this); }
    ~OpenedFiles() { set_file_watcher(nullptr, nullptr); }
    OpenedFiles(const OpenedFiles&) = delete;
    OpenedFiles& operator=(const OpenedFiles&) = delete;

    // Normal, relative where they were asked for by relative paths. While nobody opens any.
    const std::set<std::string>& paths() const { return paths_; }

  private:
    static void add(void* context, const std::string& path) {
        static_cast<OpenedFiles*>(context)->paths_.insert(
            std::filesystem::path(path).lexically_normal().string());
    }
    std::set<std::string> paths_;
};

}  // namespace coppice
