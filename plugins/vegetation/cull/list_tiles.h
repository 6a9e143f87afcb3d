// The tiles in view, nearest first: down the hierarchy as far as a tile's cloud does not suffice, then runs of plants
// for the jobs that follow. What is not in memory is wished for, and what is above it stands in.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/cull/horizon.h"
#include "plugins/vegetation/eco/tile_pack.h"
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
    float nearest_m;       // from the viewer to the bounds
    float finest_density;  // TileLevels::finest_density: where more is asked for, its points are drawn larger
    uint64_t plant_count;
    uint64_t triangle_count;
    bool stands_in = false;  // for what is not in memory yet
};

// What a frame would have drawn had it been in memory, and what is drawn from memory.
struct TileWish {
    uint32_t row;
    TileBlockKind kind;
    float priority;  // square pixels that the tile takes; less where it will only be needed soon
};

inline constexpr uint32_t k_plants_a_run = 256;

class TileList {
  public:
    using Tiles = Query<const Tile, const TileLevels>;
    using Plants = Query<const PlantPosition, const PlantTurn, const PlantModel, Owner<const Tile>>;

    struct Settings {
        float sample_distance_px;  // d'; 0: no clouds, plants everywhere
        // Where the viewer will be soon, from where it is now: what it needs there is wished for already.
        vec3 motion_m{0.0f};
        const Horizon* horizon = nullptr;  // what it hides is left out, and not wished for
        float spread_px = 0.0f;            // how far beside their geometry primitives cover pixels
        // Likewise, over their d' and times the root of c_p, of the larger points with which a cloud stands in for what is not
        // in memory yet.
        float stand_in_spread = 0.0f;
    };
    // Order: by distance of the tile's bounds, then by row. Requires a finite camera.
    void list(const Tiles& tiles, const Plants& plants, const Frustum& frustum, dvec3 camera_world,
              const Settings& settings);

    // Of all that the last list could have had in view; empty: there are no tiles.
    const Box& bounds_camera() const { return bounds_camera_; }
    // A place that moves with all there is.
    dvec3 origin_world() const { return tile_of_row_.empty() ? dvec3(0.0) : tile_of_row_[0].origin_world; }
    std::span<const PlantRun> runs() const { return runs_; }
    std::span<const CloudTile> clouds() const { return clouds_; }
    // Of tiles that are streamed; the same block may be wished for from several places.
    std::span<const TileWish> wishes() const { return wishes_; }
    // Leaves in memory; of those in view, the ones whose plants are looked at.
    uint32_t tile_count = 0, expanded_tile_count = 0;
    uint64_t plant_count = 0;         // of all places
    uint32_t touched_tile_count = 0;  // looked at on the way down
    uint32_t stand_in_count = 0;      // clouds that stand for what is not in memory yet
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
        bool drawn;          // not only wished for
        bool soon;           // will be needed, but is not yet
        dvec3 space_camera;  // where the scene of the row has its origin, from the viewer
        // Of the points that stand for it while it has no cloud: those of the tile above.
        float stand_in_spread_px;
    };
    struct SeenTile {
        vec3 origin_camera;
        Box bounds_camera;
        float stand_in_spread_px;  // of its cloud, if it stands in for what is below
        float nearest_m;
        float density, density_soon;  // that its nearest place asks for, now and where the viewer will be
        float priority;
        bool outside, inside, hidden;
        bool left_out;  // outside or hidden, and so would be what stands in for any of it
    };
    SeenTile see(const Pending& at, const Frustum& frustum, const Settings& settings) const;
    // Whether what refines its cloud lacks in memory.
    bool lacks_detail(const TileLevels& levels, const Pending& at) const;
    // Follows places down to what stands there.
    Pending arrive(Pending at) const;
    bool all_children_drawable(const TileLevels& levels, const Pending& at, float stand_in_spread_px,
                               const Frustum& frustum, const Settings& settings) const;
    void collect_plants(const Plants& plants);
    void visit(Pending at, const Frustum& frustum, const Settings& settings);
    void make_runs();

    Box bounds_camera_;
    std::span<const Tile> tile_of_row_;
    std::span<const TileLevels> levels_of_row_;
    std::vector<TilePlants> plants_of_row_;
    std::vector<Pending> pending_;
    std::vector<ExpandedTile> expanded_;
    std::vector<PlantRun> runs_;
    std::vector<CloudTile> clouds_;
    std::vector<TileWish> wishes_;
};

}  // namespace coppice
