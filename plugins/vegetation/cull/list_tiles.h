// The tiles in view, nearest first: down the hierarchy as far as a tile's cloud does not suffice, then runs of plants
// for the jobs that follow.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/cull/horizon.h"
#include "runtime/ecs/query.h"

namespace coppice {

// Plants of one tile that one job looks at. Spans hold until the next structural edit of the world.
struct PlantRun {
    vec3 origin_camera;  // the tile's origin relative to the camera, m
    bool inside;         // the whole tile is in view: its plants need no test
    std::span<const PlantPosition> positions;
    std::span<const PlantTurn> turns;
    std::span<const PlantModel> models;
    bool may_be_hidden = false;  // some of its plants may be behind the ground
};

// A tile that its cloud stands for.
struct CloudTile {
    uint32_t cloud;      // TileLevels::cloud
    vec3 origin_camera;  // m
    Box bounds_camera;
    float nearest_m;  // from the viewer to the bounds
    uint64_t plant_count;
    uint64_t triangle_count;
};

inline constexpr uint32_t k_plants_a_run = 256;

class TileList {
  public:
    using Tiles = Query<const Tile, const TileLevels>;
    using Plants = Query<const PlantPosition, const PlantTurn, const PlantModel, Owner<const Tile>>;

    struct Settings {
        float sample_distance_px;          // d'; 0: no clouds, plants everywhere
        const Horizon* horizon = nullptr;  // what it hides is left out
        float spread_px = 0.0f;            // how far beside their geometry primitives cover pixels
    };
    // Order: by distance of the tile's bounds, then by row. Requires a finite camera.
    void list(const Tiles& tiles, const Plants& plants, const Frustum& frustum, dvec3 camera_world,
              const Settings& settings);

    std::span<const PlantRun> runs() const { return runs_; }
    std::span<const CloudTile> clouds() const { return clouds_; }
    // Leaves of the hierarchy; of those in view, the ones whose plants are looked at.
    uint32_t tile_count = 0, expanded_tile_count = 0, plant_count = 0;
    uint32_t touched_tile_count = 0;  // looked at on the way down
    uint32_t hidden_tile_count = 0;   // in view but behind the horizon, with all below them

  private:
    struct TilePlants {
        std::span<const PlantPosition> positions;
        std::span<const PlantTurn> turns;
        std::span<const PlantModel> models;
    };
    struct ExpandedTile {
        float nearest_m;
        uint32_t row;
        bool inside;
        vec3 origin_camera;
        bool may_be_hidden;
    };
    struct Pending {
        uint32_t row;
        bool inside;
    };
    std::vector<TilePlants> plants_of_row_;
    std::vector<Pending> pending_;
    std::vector<ExpandedTile> expanded_;
    std::vector<PlantRun> runs_;
    std::vector<CloudTile> clouds_;
};

}  // namespace coppice
