// What certainly lies behind the drawn ground, its levels of detail included: culling by it never changes a picture.
//
// Around the viewer stand four faces of a square, one to each of +-x and +-z, each cut into columns: face +x sees what
// has x > 0 and |z| <= x, column i of it z / x in [i, i + 1] / (k_columns / 2) - 1. Let u be the coordinate along the
// face's axis. Along a ray of sight y / u and z / u do not change, so a ray is a column and a slope y / u, and where it
// reaches u = s it is within the column's segment there, as wide as the column at s, at the height slope * s.
//
// Let L be the least height, relative to the viewer, of the blocks of ground that the segment touches. A ray of slope
// < L / s is below the ground at s. The viewer is above it, and the ground is one sheet over a rectangle that holds
// viewer and segment, so the ray has gone through it from above at some u < s: there a front face was drawn, or the
// front face of a skirt where levels meet, and whatever the ray reaches at u >= s is behind that. So the horizon of a
// column at a distance u is the largest L / s of all s <= u, for heights above the viewer and below alike. The s are
// rings that all columns share, a block apart nearby and farther apart in proportion to s beyond.
//
// A box is hidden if in each column that it touches the horizon at the box's least u lies above the largest slope of its
// top: y / u at the least u where the top is above the viewer, at the greatest where it is below.
//
// Nothing is hidden from a viewer beside the terrain, below it, or so near to it that the near plane may cut it.
#pragma once
#include <array>
#include <vector>
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/cull/frustum.h"

namespace coppice {

class Horizon {
  public:
    // Of the terrain, or none, as drawn with choose_ground_level(error_px). Only columns in view are made. Allocates for
    // a terrain larger than those before.
    void build(const Terrain* terrain, dvec3 camera_world, const Frustum& frustum, float error_px);

    // True only where no pixel can show any of what the box holds. Bounds are camera-relative. spread_px: how far beside
    // their geometry its primitives cover pixels, along an axis of the picture. Any thread.
    bool hidden(const Box& bounds_camera, float spread_px) const;

    // Whether it pays to ask for pieces of the box: false where hardly anything of it is hidden. Any thread.
    bool hides_some(const Box& bounds_camera) const;

    // Whether anything can be hidden at all.
    bool empty() const { return ring_count_ == 0; }

  private:
    static constexpr uint32_t k_columns = 256;  // of a face
    struct Place;
    struct ColumnRange {
        uint32_t first = 0, end = 0;
    };

    // What of a box lies on a face, in view: columns [first, last], u in [begin, end].
    struct Span {
        uint32_t first, last;
        float u_begin, u_end;
    };
    bool span_of(const Box& box, uint32_t face, Span& span) const;
    // Of the last ring up to u; nullptr: none.
    const float* slopes_at(uint32_t face, float u) const;
    bool choose_levels(const Terrain& terrain, const Place& place, const Frustum& frustum, float error_px);
    void see_columns(const Frustum& frustum);
    bool add_ring(const Terrain& terrain, const Place& place, uint32_t face, float ring, float* slopes);

    float focal_px_ = 1.0f;
    uint32_t ring_count_ = 0;
    std::array<ColumnRange, 4> seen_;    // of each face: +x, -x, +z, -z
    std::vector<float> rings_m_;         // ascending
    std::vector<float> slopes_;          // of each ring the faces' columns; those not seen are not set
    std::vector<uint32_t> drawn_level_;  // of each patch, into Terrain::levels
    std::vector<float> line_;            // heights of a row of blocks
};

}  // namespace coppice
