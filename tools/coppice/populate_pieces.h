// The pieces a populated scene consists of: packed plants, packs of tiles, and scene.json, which names them all; a mosaic's
// scene.json names those of its scenes. Each is made on its own from what the author wrote and the pieces before it, is
// written whole or not at all, and says in its name or head what it was made of: so any of them can be made by another
// process, and none is made twice.
#pragma once
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/eco/mosaic_tree.h"
#include "plugins/vegetation/eco/populated_scene.h"

namespace coppice {

struct PopulateSettings {
    std::string scene;                // *.eco.json
    std::string folder;               // where the pieces go
    std::string plants = "plants";    // where in it the plants go: scenes of a mosaic share theirs
    std::string cache_dir;            // of measured populations; empty: the user's
    uint64_t pack_plants = 1u << 20;  // of one pack, at most; but a tile is never divided
    const TerrainInterface* terrain = nullptr;
    const ModellerInterface* modeller = nullptr;
    const ImagesInterface* images = nullptr;  // may be null where no plant has textures
    std::function<const ImagesInterface*()> find_images;  // for maps of density
};

struct PlantPiece {
    // In the folder: "plants/oak-0123456789abcdef.plant", the hash being that of all it is made of.
    std::string name;
    std::string source_path;
    uint64_t variation;
};

struct PackPiece {
    std::string name;  // "tiles/woodland-0.tiles"
    uint32_t first_tile, tile_count;
};

inline constexpr const char* k_scene_piece = "scene.json";

struct Pieces {
    PopulateSettings settings;
    Scene scene;
    std::string terrain_json;              // as the author wrote it
    std::vector<PlantPiece> plants;        // all different
    std::vector<uint32_t> plant_of_model;  // of scene.models
    std::vector<PackPiece> packs;
    std::set<std::string> authored;  // the files that the scene was read from
};

// Reads the scene. Nothing is cooked. Errors: load_scene's.
Result<Pieces> list_pieces(const PopulateSettings& settings);

enum class Outcome { made, kept };

// One packed plant; kept where it is there and sound.
Result<Outcome> make_plant(const Pieces& pieces, const PlantPiece& piece);

// The plants of all models, in their order. Errors: of those that were not made.
Result<std::vector<Plant>> load_plants(const Pieces& pieces);

// One pack; kept where it is there, sound, and was made of the same. Takes plants as load_plants gives them.
Result<Outcome> make_pack(const Pieces& pieces, const PackPiece& piece, std::span<const Plant> plants);

// scene.json, from packs that have been made; and beside it the files its ground needs.
Result<Outcome> make_scene(const Pieces& pieces, std::span<const Plant> plants);

// Of a scene below a mosaic, what its pieces take; of the only scene, the settings as they are.
PopulateSettings settings_of(const PopulateSettings& settings, const MosaicNode& node);

// scene.json of a mosaic in the tree of settings.scene, from those of the scenes it consists of.
Result<Outcome> make_mosaic(const PopulateSettings& settings, const MosaicTree& tree, const MosaicNode& node);

// populate.cpp: all pieces of settings.scene, a scene or a mosaic, with progress; what is there and sound is kept.
Status populate(const PopulateSettings& settings);

}  // namespace coppice
