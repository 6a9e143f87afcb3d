// Where a crown's leaves stand between all triangles and points.
#pragma once
#include <algorithm>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// A leaf takes the place of so many points, and has as many vertices: a count of vertices is the same with either.
inline constexpr float k_points_a_leaf = 4.0f;

// Leaves are drawn where the part asks for p points, from <= p < to: p / k_points_a_leaf of them, all where that is more
// than there are. to <= from: nowhere.
struct LeafRange {
    float from, to;
};

// Wherever there are levels, up to where all triangles have no more vertices than points would have: those are the truth.
inline LeafRange whole_leaf_range(const PackedPart& part, uint32_t least_count) {
    return {k_points_a_leaf * float(least_count), 3.0f * float(part.triangle_count)};
}

// Where leaves were measured to be nearer to the truth than points in the same time (docs/decisions.md 41): as long as no
// more than half of them have been joined. And where there are no more points than leaves have vertices: what a budget
// counts changes with neither end. Nowhere where all leaves have no fewer vertices than their triangles.
inline constexpr float k_fewest_leaves_share = 0.5f;
inline LeafRange automatic_leaf_range(const PackedPart& part, uint32_t full_count, uint32_t least_count) {
    const LeafRange whole = whole_leaf_range(part, least_count);
    const float all = k_points_a_leaf * float(full_count);
    return all < whole.to ? LeafRange{std::max(whole.from, k_fewest_leaves_share * all), all}
                          : LeafRange{0.0f, 0.0f};
}

}  // namespace coppice
