// The grounds in view: those of the scenes that a world consists of, each as often as its scene stands there; as a few
// triangles where that is off by less than a pixel, and many as one square.
#pragma once
#include <memory>
#include <span>
#include <vector>
#include "plugins/vegetation/cull/coarse_ground.h"
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/eco/tile_forest.h"

namespace coppice {

struct Ground {
    struct Place {
        dvec3 origin;  // of the other ground's space in this one's
        uint32_t ground;
    };
    std::shared_ptr<const Terrain> terrain;  // null: that of its places
    std::vector<Place> places;
    Box bounds;           // in its own space
    CoarseGround coarse;  // no levels: only in full
};
inline constexpr uint32_t k_in_full = UINT32_MAX;

// One terrain, or none.
std::vector<Ground> make_grounds(std::shared_ptr<const Terrain> terrain);
// Of a forest, in its order: ground 0 is the root's.
std::vector<Ground> make_grounds(const TileForest& forest);

struct GroundInView {
    uint32_t ground;
    dvec3 space_camera;     // where its space has its origin, from the viewer
    uint32_t coarse_level;  // of CoarseGround::levels, or k_in_full
};

class GroundList {
  public:
    // Requires a finite camera. In the order of the grounds' places. error_px: what a coarse ground may be off by; 0: all in full.
    void list(std::span<const Ground> grounds, const Frustum& frustum, dvec3 camera_world, float error_px);
    std::span<const GroundInView> in_view() const { return in_view_; }

  private:
    std::vector<GroundInView> pending_, in_view_;
};

}  // namespace coppice
