// What throws shadows into the picture, and the map it is drawn into: found, looked at and listed as what is seen is, with the
// viewer's level of detail at twice its d', in the view's shift towards the sun.
#pragma once
#include "plugins/vegetation/draw/expand_ground.h"
#include "plugins/vegetation/draw/frame_plants.h"
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

class FrameCasters {
  public:
    // Which tiles, and the map's view. Without a sun, or with shadows off, there are none, and where the map would be as large as
    // one that found no room. pixel_count: of the picture; scene_bounds: all that there is, relative to the camera;
    // nearest_m: from the viewer to what is seen, about: the map is as fine as a pixel there.
    void list(const TileList::Tiles& tiles, const TileList::Plants& plants, const SceneGeometry& geometry,
              std::span<const Ground> grounds, const Frustum& view, dvec3 camera_world, const Light& light,
              const FrameSettings& settings, uint64_t pixel_count, uint32_t refused_side_texels, const Box& scene_bounds, float nearest_m);
    // The plants of the tiles listed last.
    void see(const SceneGeometry& geometry);

    bool any() const { return side_texels_ > 0; }
    // There is no room for the map: shadows are off for the frame.
    void drop() { side_texels_ = 0; }
    uint32_t side_texels() const { return side_texels_; }
    const ShadowView& view() const { return view_; }
    // What of a streamed world is missing.
    std::span<const TileWish> wishes() const {
        return any() ? tiles_.wishes() : std::span<const TileWish>();
    }

    uint32_t plant_count() const;  // that throw shadows, without those that clouds stand for
    // Of the work list; 0 without shadows.
    size_t part_count() const { return any() ? tiles_.runs().size() + 2 : 0; }
    void draw(const SceneGeometry& geometry, const FrameSettings& settings, uint32_t rest_index, WorkList& work,
              size_t first_part);

  private:
    vec3 to_sun_{0.0f, 1.0f, 0.0f};
    Frustum frustum_{};
    TileList tiles_;
    GroundList grounds_;
    GroundExpander ground_expander_;
    FramePlants plants_;
    ShadowView view_{};
    uint32_t side_texels_ = 0;
    float spread_px_ = 0.0f;  // of primitives, beside their geometry
};

}  // namespace coppice
