// The files that are opened to be read as long as this lives: what a scene or a plant was made from. Who was
// told of them before still is; those that live at a time end in reverse.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include "runtime/core/file_watcher.h"

namespace coppice {

class OpenedFiles {
  public:
    OpenedFiles() : before_(set_file_watcher(&OpenedFiles::add, this)) {}
    ~OpenedFiles() { set_file_watcher(before_.watcher, before_.context); }
    OpenedFiles(const OpenedFiles&) = delete;
    OpenedFiles& operator=(const OpenedFiles&) = delete;

    // Normal, relative where they were asked for by relative paths. While nobody opens any.
    const std::set<std::string>& paths() const { return paths_; }

  private:
    static void add(void* context, const std::string& path) {
        OpenedFiles& opened = *static_cast<OpenedFiles*>(context);
        opened.paths_.insert(std::filesystem::path(path).lexically_normal().string());
        if (opened.before_.watcher) opened.before_.watcher(opened.before_.context, path);
    }
    std::set<std::string> paths_;
    FileWatching before_;
};

}  // namespace coppice
