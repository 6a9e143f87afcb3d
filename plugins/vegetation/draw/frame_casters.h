// What throws shadows into the picture, and the maps it is drawn into: found, looked at and listed as what is seen is.
#pragma once
#include "plugins/vegetation/draw/expand_ground.h"
#include "plugins/vegetation/draw/frame_plants.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/shadow/clipmap.h"

namespace coppice {

// Of one map.
class MapCasters {
  public:
    // What of the world the frustum holds.
    void list(const TileList::Tiles& tiles, const TileList::Plants& plants, const SceneGeometry& geometry,
              std::span<const Ground> grounds, const Frustum& frustum, dvec3 camera_world,
              const FrameSettings& settings);
    void see(const SceneGeometry& geometry) { plants_.see(tiles_, geometry, frustum_, nullptr, spread_px_); }
    // Parts [first_part, first_part + part_count()) of the work list. Ground that is nowhere steeper than least_slope throws none.
    size_t part_count() const { return tiles_.runs().size() + 2; }
    void draw(const SceneGeometry& geometry, uint32_t rest_index, float least_slope, WorkList& work,
              size_t first_part);
    // What of a streamed world was missing when it was listed.
    std::span<const TileWish> wishes() const { return tiles_.wishes(); }
    bool is_incomplete() const { return tiles_.stand_in_count > 0; }
    uint32_t plant_count() const;  // without those that clouds stand for

  private:
    Frustum frustum_{};
    FrameSettings settings_;
    TileList tiles_;
    GroundList grounds_;
    GroundExpander ground_expander_;
    FramePlants plants_;
    float spread_px_ = 0.0f;  // of primitives, beside their geometry
};

class FrameCasters {
  public:
    struct View {
        Frustum frustum;
        dvec3 camera_world, origin_world;
        vec3 motion_m;       // where the viewer will be soon, from where it is
        uint64_t pixel_count;
        Box scene_bounds;    // all that there is, relative to the camera
        float nearest_m;     // from the viewer to what is seen, about
        uint64_t most_map_bytes;      // of all maps together, that the device takes
        uint64_t refused_map_bytes;   // found no room: maps of so much are not drawn
    };
    // Which maps are to be drawn, and which tiles into them. Without a sun, or with shadows off, there are none. settings: of the
    // frame as it is drawn. May be called again before the frame is drawn.
    void list(const TileList::Tiles& tiles, const TileList::Plants& plants, const SceneGeometry& geometry,
              std::span<const Ground> grounds, const View& view, const Light& light,
              const FrameSettings& settings);
    // The plants of the tiles listed last.
    void see(const SceneGeometry& geometry);

    bool any() const { return side_texels_ > 0; }
    // There is no room for the maps: shadows are off for the frame.
    void drop();
    uint32_t side_texels() const { return side_texels_; }
    uint32_t map_count() const { return map_count_; }
    uint64_t map_bytes() const { return uint64_t(side_texels_) * side_texels_ * 4 * map_count_; }
    uint32_t drawn_map_count() const { return uint32_t(drawn_.size()); }
    // Of maps that stay, some are others than in the frame before.
    bool changed_kept_maps() const { return is_nested_ && !drawn_.empty(); }
    ShadowSettings maps() const;
    // What of a streamed world is missing.
    void add_wishes(std::vector<TileWish>& wishes) const;

    uint32_t plant_count() const;  // of the maps that are drawn; without those that clouds stand for
    // Of the work list, a map each.
    std::span<const size_t> part_counts() const { return part_counts_; }
    void draw(const SceneGeometry& geometry, uint32_t rest_index, WorkList& work, size_t first_part);

    // The frame has been set: of maps that stay so many, from the first, are what they were to be; of others some did not fit
    // into the work list.
    void commit(uint32_t whole_maps);
    // What is seen is not what it was: maps that stay are drawn anew.
    void forget() { clipmap_.forget(); }
    // More of a streamed world has been read.
    void note_arrivals() { clipmap_.note_arrivals(); }
    // Some plants have come, gone or moved.
    void note_changes() { clipmap_.note_changes(); }

  private:
    void list_warped(const TileList::Tiles& tiles, const TileList::Plants& plants,
                     const SceneGeometry& geometry, std::span<const Ground> grounds, const View& view,
                     const FrameSettings& settings, float far_m);
    void list_nested(const TileList::Tiles& tiles, const TileList::Plants& plants,
                     const SceneGeometry& geometry, std::span<const Ground> grounds, const View& view,
                     const FrameSettings& settings, float far_m);

    vec3 to_sun_{0.0f, 1.0f, 0.0f};
    float far_m_ = 0.0f;
    uint32_t side_texels_ = 0, map_count_ = 1;
    bool is_nested_ = false;
    Clipmap clipmap_;
    std::array<MapCasters, k_most_work_maps> casters_;  // by place
    std::vector<ShadowMapDraw> drawn_;
    std::vector<ShadowView> seen_;
    std::vector<size_t> part_counts_;
};

}  // namespace coppice
