// Files that live as long as a test, and the terrain plugin without its module.
#pragma once
#include <cstdio>
#include <string>
#include <string_view>
#include <unistd.h>
#include <gtest/gtest.h>
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "runtime/core/file.h"

namespace coppice {

class ScratchFile {
  public:
    ScratchFile(const std::string& name, std::string_view text)
        : path_(testing::TempDir() + "eco_test_" + std::to_string(::getpid()) + "_" + name) {
        EXPECT_TRUE(write_text_file(path_, text).has_value());
    }
    ~ScratchFile() { std::remove(path_.c_str()); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

inline Result<Scene> load_scene_text(std::string_view text, const char* name = "scene.eco.json") {
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    ScratchFile file(name, text);
    return load_scene(file.path(), {&k_terrain});
}

}  // namespace coppice
