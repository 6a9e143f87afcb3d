// Reads an *.eco.json scene: plants used, where they stand, terrain, sun, flight. The format is in README.md.
#pragma once
#include <functional>
#include <string>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/eco/place_named.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

struct SceneLoadSettings {
    const TerrainInterface* terrain = nullptr;    // null: a scene with a terrain is refused
    const ModellerInterface* modeller = nullptr;  // null: a scene with a population to quantise is refused
    std::string cache_dir;                        // of measured populations; empty: measured each time
    // Of scenes' files and their packed plants; for who has them in memory. Empty: read from the disk.
    std::function<Result<std::string>(const std::string& path)> read_file;
    // Asked for where a density map is neither PGM nor PPM; empty: such a map is refused.
    std::function<const ImagesInterface*()> find_images;
    // Of a glTF file; empty: a scene with such placements is refused.
    ReadNamedPlaces read_gltf;
};

// Deterministic: same files, same scene, on any number of threads. Tiles' bounds hold only the plants' feet
// until finish_tiles. Every key, number and name is checked; nothing large is allocated before its size is.
// Errors: file_*, syntax (line and column), name_unknown (with the nearest known), value_out_of_range,
// limit_exceeded.
Result<Scene> load_scene(const std::string& path, const SceneLoadSettings& settings);

}  // namespace coppice
