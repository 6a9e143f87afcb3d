// Files that live as long as a test, in a folder of this process alone, and the terrain plugin without its
// module.
#pragma once
#include <filesystem>
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
        : folder_(testing::TempDir() + "eco_test_" + std::to_string(::getpid())),
          path_(folder_ + "/" + name) {
        EXPECT_TRUE(write_text_file(path_, text).has_value());
    }
    ~ScratchFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
        std::filesystem::remove(folder_, ignored);  // fails while others are in it
    }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    const std::string& path() const { return path_; }

  private:
    std::string folder_, path_;
};

inline Result<Scene> load_scene_text(std::string_view text, const char* name = "scene.eco.json") {
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    ScratchFile file(name, text);
    return load_scene(file.path(), {&k_terrain});
}

}  // namespace coppice
