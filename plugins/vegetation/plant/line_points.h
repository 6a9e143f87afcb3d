// Points that stand for a part of lines where it is far away: there lines are no longer than they are wide, or a line of
// one plant would stand for those of three, and both a plant and its tile's cloud draw these in their place.
// Point i lies on line i mod n_l, in its middle while i < n_l, and is as large as that line is wide. So a prefix of them is
// a prefix of the lines, right in colour and width as those are. Of a stem they face all sides in turn, by the golden angle.
#pragma once
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// n_l, or a multiple of it if that is few; 0 where the part has no lines.
uint32_t line_point_count(const PackedPart& part);

struct LinePoint {
    PackedVertex vertex;  // plant space
    float width_share;    // of its line: over the part's mean
};
// Requires the plant's line vertices and i < line_point_count.
LinePoint line_point(const PackedPart& part, std::span<const PackedVertex> line_vertices, uint32_t i);

// A density (eco/make_cloud.h) to 2^-16 of itself with, in its lowest 8 bits, how large its point is drawn: the side over
// that of others is 2^((bits - 128) / 32), the root of its share of their area. draw/splat_points.comp reads it.
inline constexpr uint32_t k_side_bits = 8;
inline constexpr float k_least_area_share = 1.0f / 128.0f, k_largest_area_share = 128.0f;
float pack_density(double density, float area_share);

}  // namespace coppice
