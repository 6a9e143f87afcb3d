// The tiles in view, nearest first, cut into runs of plants for the jobs that follow.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/cull/frustum.h"
#include "runtime/ecs/query.h"

namespace coppice {

// Plants of one tile that one job looks at. Spans hold until the next structural edit of the world.
struct PlantRun {
    vec3 origin_camera;  // the tile's origin relative to the camera, m
    bool inside;         // the whole tile is in view: its plants need no test
    std::span<const PlantPosition> positions;
    std::span<const PlantTurn> turns;
    std::span<const PlantModel> models;
};

inline constexpr uint32_t k_plants_a_run = 256;

class TileList {
  public:
    using Plants = Query<const PlantPosition, const PlantTurn, const PlantModel, Owner<const Tile>>;

    // Order: by distance of the tile's bounds, then by the tile's first plant. Requires a finite camera.
    void list(const Plants& plants, const Frustum& frustum, dvec3 camera_world);

    std::span<const PlantRun> runs() const { return runs_; }
    uint32_t tile_count = 0, visible_tile_count = 0, plant_count = 0;

  private:
    struct VisibleTile {
        float distance_m;
        uint32_t first_index;  // of the tile's first entity
        PlantRun plants;
    };
    std::vector<VisibleTile> tiles_;
    std::vector<PlantRun> runs_;
};

}  // namespace coppice
