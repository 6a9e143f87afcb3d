// A mosaic: a scene that consists of other scenes, each with its own ground, which stand beside each other untouched. No
// file of one is as large as what it shows, because a scene is held once however often it stands; a mosaic may consist of
// mosaics. Source: Deussen et al. 2002, 6.2 (eco files that refer to eco files).
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

inline constexpr uint64_t k_mosaic_place_limit = 64;  // copies of all scenes that one mosaic names

// Another scene, once or on a grid about `at`, neither turned nor scaled.
struct PlacedScene {
    std::string path;           // resolved
    std::string place;          // in the file that names it: "mosaic[2]"
    uint64_t content_hash = 0;  // of the text of a populated scene; an authored one has none
    dvec3 at{0.0};              // y is 0
    uint32_t columns = 1, rows = 1;
    double spacing_m = 0.0;

    uint64_t copy_count() const { return uint64_t(columns) * rows; }
    // Where its origin comes to lie, by rows; whole multiples of 1/16 m, so that sums of them are exact.
    dvec3 origin_of(uint64_t copy) const {
        return at + dvec3(double(copy % columns) - 0.5 * (columns - 1), 0.0,
                          double(copy / columns) - 0.5 * (rows - 1)) *
                        spacing_m;
    }
};

// What is wrong goes to the document. folder: what paths are relative to. `populated`: with content hashes.
std::vector<PlacedScene> read_placed_scenes(JsonObject& root, const std::filesystem::path& folder,
                                            bool populated);
// An object's "content", 16 hexadecimal digits.
uint64_t read_content_hash(JsonObject& object);
// The entry that is read so, with its path as it is. Of a populated mosaic.
nlohmann::ordered_json json_of(const PlacedScene& placed);

// What an author wrote.
struct MosaicFile {
    std::string name;
    Light light;
    float sample_distance_px = 1.0f;
    std::vector<PlacedScene>
        places;  // none: no mosaic, but a scene with plants of its own, which was not read
    std::vector<CameraKey> camera_path;
};

// ground: of the mosaic, which keys may be above. Errors: load_scene's.
Result<MosaicFile> read_mosaic_file(const std::string& path, const GroundHeight& ground);

}  // namespace coppice
