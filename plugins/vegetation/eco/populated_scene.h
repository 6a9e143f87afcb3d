// A scene whose plants stand in packed tiles, or a mosaic of such: what a player needs beside them, as scene.json in the
// folder that `coppice populate` made. Unlike an *.eco.json it says nothing of how the plants came to stand where they are; all paths are
// relative to it, so the folder can be carried away.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "plugins/vegetation/eco/mosaic.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/eco/tile_pack.h"

namespace coppice {

struct ScenePack {
    std::string path;
    uint64_t content_hash = 0;  // TilePack::content_hash
    uint64_t plant_count = 0, triangle_count = 0;
};

struct PopulatedScene {
    Scene scene;                                 // no tiles, no plants; models are packed plants
    std::vector<uint64_t> model_content_hashes;  // Plant::content_hash
    std::vector<ScenePack> packs;
    std::string terrain_json;  // the "terrain" object of the scene; empty: none
    // What a mosaic consists of; it has no packs, plants and terrain of its own.
    std::vector<PlacedScene> mosaic;
    uint64_t content_hash = 0;  // of the text it was read from
};

// The scene.json of a folder that `coppice populate` made, for its path or the folder's; else empty.
std::string populated_scene_file(const std::string& path);

// Paths as they are. Same scene, same text. Requires a terrain_json that was read before.
std::string write_populated_scene(const PopulatedScene& populated);

// Paths resolved against the file. terrain may be null where the scene has none. Strict as load_scene, whose errors it has.
Result<PopulatedScene> load_populated_scene(const std::string& path, const TerrainInterface* terrain);

// All packs, which must be those the scene was written with, and made of its plants. Errors: open_tile_pack's; file_corrupt
// where something was replaced.
Result<std::vector<TilePack>> open_packs(const PopulatedScene& populated);
// plants[i] is what scene.models[i] loaded as. Errors: file_corrupt where it is not the plant the scene was written with.
Status check_plants(const PopulatedScene& populated, std::span<const Plant> plants);

}  // namespace coppice
