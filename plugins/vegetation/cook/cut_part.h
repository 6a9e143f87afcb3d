// Octree cells of a packed part: what viewers near the plant draw in its place. A cell takes its share of the
// part's triangles, points and lines in the order in which the part draws them, so each prefix of the part's
// is a prefix of every cell's, and handing over between them cannot pop.
#pragma once
#include <span>
#include "plugins/vegetation/cook/build_octree.h"
#include "plugins/vegetation/plant/pack.h"

namespace coppice {

// Of its points a part in cells keeps the first quarter. From farther away than cells are drawn for their own
// sake a view seldom asks for more, and where it does, cells are drawn.
inline constexpr float k_kept_points_share = 0.25f;

// Lines with the triangles around them (line_of_triangle, in their packed order), or triangles where there
// are none. packed: of one part.
OctreeUnits list_units(const PlantBlocks& packed, std::span<const uint32_t> line_of_triangle);

// cell_of_unit: of list_units, numbers from 0 up without gaps. Returns the cells, in `cells`, with their
// points and lines behind each other in `points`, `point_owners` and `line_vertices`, and their triangles in
// packed, which are sorted by cell; the rest is empty. Names, flags, importance, gain and eps_l are the
// part's.
PlantBlocks cut_part(PlantBlocks& packed, std::span<const uint32_t> cell_of_unit,
                     std::span<const uint32_t> line_of_triangle);

}  // namespace coppice
