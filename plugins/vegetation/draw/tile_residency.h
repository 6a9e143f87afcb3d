// Keeps in memory what the frames wish for: plants of tiles as chunks of the world, clouds in places of the geometry
// buffer, both within their budgets. What is wished for less gives way to what is wished for more; a place of the geometry
// buffer that nobody wishes for is the first to be used again.
#pragma once
#include <memory>
#include <vector>
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/eco/stream_tiles.h"
#include "runtime/ecs/world.h"

namespace coppice {

struct ResidencyStatistics {
    TileStreamStatistics stream;
    uint32_t clouds = 0, plant_tiles = 0;  // in memory, streamed
};

class TileResidency {
  public:
    // Takes the forest's packs. Of the clouds of the geometry that draws it, those streamed are the last
    // cloud_count(settings), behind pinned_clouds others.
    TileResidency(TileForest& forest, const ResidencySettings& settings, uint32_t pinned_clouds);

    static uint32_t cloud_count(const ResidencySettings& settings);

    // What came since the last frame is put where it is drawn from, and what has to give way is dropped. Edits the world.
    // At once: through the device's queue, waiting; else through the slot's ring, and what does not fit there waits for
    // the next frame. True where something came, or something that is wished for went. A tile that cannot be read is reported once; its parent's cloud stays.
    bool update(World& world, ChunkId tiles, SceneGeometry& geometry, Rasteriser& rasteriser, uint32_t slot,
                bool at_once);
    // All plants' chunks; for nothing else than the end.
    void drop_plants(World& world);
    // In place of what was wished for before.
    void wish(std::span<const TileWish> wishes);
    // Until everything wished for was read that has room.
    void wait() { streamer_.wait_until_read(); }
    ResidencyStatistics statistics() const;

  private:
    static constexpr uint32_t k_none = TileLevels::k_none;
    struct Row {
        uint32_t pack = k_none, node = 0;
        uint32_t place = k_none;  // of the streamed clouds
        uint32_t cloud_wished_at = 0, plants_wished_at = 0;
        bool cloud_is_pinned = false;
        ChunkId plants;
    };
    struct Place {
        uint32_t row = k_none;
        uint32_t filled_at = 0;  // update(): two copies of one frame must not go to one place
    };
    uint32_t find_place(World& world, ChunkId tiles);
    void set_cloud_of(World& world, ChunkId tiles, uint32_t row, uint32_t cloud);
    bool add_cloud(World& world, ChunkId tiles, SceneGeometry& geometry, Rasteriser& rasteriser,
                   uint32_t slot, bool at_once, const FinishedTileBlock& block, uint32_t row);
    void add_plants(World& world, ChunkId tiles, const FinishedTileBlock& block, uint32_t row);
    void drop(World& world, ChunkId tiles, TileBlockName block);
    uint32_t row_of(TileBlockName block) const { return row_of_node_[first_node_[block.pack] + block.node]; }

    TileStreamer streamer_;
    std::vector<Row> rows_;
    std::vector<uint32_t> first_node_, row_of_node_;  // of packs and their nodes
    std::vector<uint32_t> first_model_;               // of packs
    std::vector<Place> places_;
    std::vector<uint32_t> free_places_;
    const uint32_t pinned_clouds_;
    uint32_t turn_ = 0;     // of wish()
    uint32_t updates_ = 0;  // of update()
    uint32_t plant_tiles_ = 0;
    std::vector<TileRequest> requests_;
    std::vector<FinishedTileBlock> finished_, arrived_;
    std::vector<TileBlockName> evictions_;
};

}  // namespace coppice
