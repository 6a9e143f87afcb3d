// The tiles of a world larger than memory: trees of packed tiles, joined, and scenes that stand in many places held once.
// A row is a tile; its place in the world is the sum of the places on the way down to it, so that a scene of 10^12
// triangles is as many rows as its different squares have.
// Source: Deussen et al. 2002, 6.2 (eco files that refer to eco files).
#pragma once
#include <memory>
#include <string>
#include <vector>
#include "plugins/vegetation/eco/make_cloud.h"
#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/eco/tile_pack.h"

namespace coppice {

inline constexpr uint32_t k_no_row = UINT32_MAX;

// One of three: a leaf, whose plants are a block of its pack; a parent of children [first_child, first_child +
// child_count); or a place, where another row of the forest stands. A leaf without a pack is a scene without plants, of
// which only the ground is there: its cloud is empty and suffices at every density, its bounds are the ground's.
struct ForestRow {
    dvec3 origin{
        0.0};  // in the space of the scene it belongs to; of a place: where the target's space has its origin
    Box bounds_tile;  // relative to the origin, of all plants below at full size; of a place: the target's, in its space
    uint32_t first_child = 0, child_count = 0;  // rows behind this one
    uint32_t target = k_no_row;                 // of a place: a row behind this one
    uint32_t pack = k_no_row, node = 0;         // where its blocks are
    // Of TileForest::clouds; none: it is read from its pack when it is needed, or is that of a place's target.
    uint32_t cloud = k_no_row;
    uint32_t ground =
        k_no_row;  // of TileForest::grounds: of a row whose ground begins here, or is that of its children
    float finest_density = 0.0f;                   // the cloud suffices up to (pixels a metre / d')^2
    uint64_t plant_count = 0, triangle_count = 0;  // of all below
};

// Relative to its origin. Skirts hang below and lean beside the ground, into a neighbour's: from above they are left out.
Box bounds_without_skirts(const Terrain& terrain);

// The ground under a row, in its space.
struct ForestGround {
    std::shared_ptr<const Terrain> terrain;  // null: the grounds of the places below it
    Box bounds;  // of the ground, in the space of the row's scene; from above without the skirts at its border
    // A flat square stands for it where the differences in height are less than a pixel; only where it has no gaps.
    bool without_gaps = false;
    vec3 mean_color_linear{0.0f};
};

struct TileForest {
    std::string name, path;
    // Of all scenes; source_path is that of the packed plant. A plant is here twice where scenes have different lists of
    // models, because a pack's models follow each other; such have one source_path if they were populated together.
    std::vector<SceneModel> models;
    std::vector<uint64_t> model_content_hashes;
    std::vector<TilePack> packs;
    std::vector<uint32_t> first_model;  // of each pack: its plants' model 0 is this one of `models`
    std::vector<ForestRow> rows;        // row 0 is the root; none: no plant and no ground
    std::vector<TileCloud> clouds;      // of joined rows and of packs' roots, which are always needed
    std::vector<ForestGround> grounds;  // 0 is the root's, where there is any
    Light light;
    std::vector<CameraKey> camera_path;  // at least one key
    float sample_distance_px = 1.0f;
};

// Of a populated scene or mosaic. Each scene below is loaded once, however often it stands. Same files, same forest.
// terrain may be null where no scene has a ground. Errors: load_populated_scene's, open_packs', read_cloud's of packs' roots;
// file_corrupt for a scene that is not the one its mosaic was populated with; value_out_of_range for a mosaic in itself and
// for places out of reach; limit_exceeded for chains of more than k_reference_depth_limit, and for numbers of plants,
// triangles, models and rows that cannot be held.
Result<TileForest> load_forest(const std::string& path, const TerrainInterface* terrain);
// The same of a root that may not have been written yet.
Result<TileForest> make_forest(const PopulatedScene& root, const TerrainInterface* terrain);

// Those of all models, in their order. Errors: load_plant's; file_corrupt for one that is not what a scene was populated with.
Result<std::vector<Plant>> load_plants(const TileForest& forest);

// Of the ground below (x, z), or where there is none of the nearest; 0 in a forest without grounds.
double ground_height(const TileForest& forest, double x_world, double z_world);

}  // namespace coppice
