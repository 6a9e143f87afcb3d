// Lanes of a device draw triangles side by side, and all wait for the largest: so triangles that are drawn together are made
// alike in size, as far as prefixes allow.
#pragma once
#include "plugins/vegetation/plant/pack.h"

namespace coppice {

inline constexpr uint32_t k_triangles_a_lane_group = 8;  // of lavapipe; wider devices take several alike
inline constexpr uint32_t k_triangles_a_run = 256;       // k_primitives_a_group of draw/work_list.h

// Reorders the triangles of each part, or of each of its cells, within runs: each group of a run has triangles of like
// longest edge, and groups come in the order of their first members. So what a prefix holds changes by less than a run, and
// no size comes before another. Point owners follow. Requires blocks as pack_plant takes them.
void group_triangles(PlantBlocks& plant);

}  // namespace coppice
