// Large plants in pieces: who stands beside a crown sees its near side in full and its far side from twice as
// far away, so each piece chooses its level of detail for itself. Source: Deussen et al. 2002, 5.1: an octree
// of small depth over large plants (DESIGN section 3, ERRATA 3).
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

// Radius of the sphere about the plant's box: of smaller plants no side is much nearer than another, but for
// viewers who stand in them.
inline constexpr float k_octree_least_radius_m = 3.0f;
// A cell's decision is worth it where it draws a few metres of crown, thousands of triangles: each costs
// every instance near the viewer a decision every frame.
inline constexpr float k_cell_least_side_m = 2.0f;
inline constexpr uint32_t k_octree_depth_limit = 2;
inline constexpr uint32_t k_cell_least_triangles =
    2048;                                     // in the mean over the cells that a cell is cut into
inline constexpr uint32_t k_cell_limit = 64;  // of a plant, parts that stay whole counted

// What a part consists of: units that go to one cell as a whole.
struct OctreeUnits {
    std::vector<vec3> middle_plant;
    std::vector<uint32_t> triangle_count;
};

// For each part the cell of each unit: numbers from 0 up without gaps, each with triangles; all 0 where the
// part stays whole. The cells of all parts lie in one octree over the plant, a cube about its box, which is
// cut, largest cells first, while there are no more than cell_limit in all. Octants with few triangles join
// the next one. Pure, ties by index.
std::vector<std::vector<uint32_t>> build_octree(std::span<const OctreeUnits> parts, const Box& bounds_plant,
                                                uint32_t cell_limit = k_cell_limit);

}  // namespace coppice
