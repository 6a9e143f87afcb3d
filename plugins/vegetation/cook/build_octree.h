// Large plants in pieces: who stands beside a crown sees its near side in full and its far side from twice as far away,
// so each piece chooses its level of detail for itself. Source: Deussen et al. 2002, 5.1: an octree of small depth over
// large plants (DESIGN section 3, ERRATA 3).
#pragma once
#include "plugins/vegetation/cook/merge_parts.h"

namespace coppice {

// Radius of the sphere about the plant's box: of smaller plants no side is much nearer than another, but for viewers who
// stand in them.
inline constexpr float k_octree_least_radius_m = 3.0f;
// A cell's decision is worth it where it draws a few metres of crown, thousands of triangles; each costs every instance of
// the plant a decision every frame.
inline constexpr float k_cell_least_side_m = 2.0f;
inline constexpr uint32_t k_octree_depth_limit = 2;
inline constexpr uint32_t k_cell_least_triangles =
    2048;  // in the mean over the cells that a cell is cut into

// For each part its cells; itself alone where it stays whole. The cells of all parts lie in one octree over the plant: a
// cube about its box, which is cut, largest cells first, while there are no more than part_limit cells in all. Leaves go
// where their middle lies, stems by segments, other triangles one by one; cells with few triangles join the next one.
// Triangles and segments keep their order, nothing is lost. Follows merge_parts: cells look alike and would be merged.
// Pure, ties by index.
std::vector<std::vector<CookPart>> build_octree(std::vector<CookPart> parts,
                                                uint32_t part_limit = k_part_limit);

}  // namespace coppice
