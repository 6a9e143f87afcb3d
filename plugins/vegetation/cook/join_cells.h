// A part that was cut into octree cells, in one piece again: what stands for it far away, where one decision for all is
// enough. Its points and lines are the cells' own, so that handing over between part and cells cannot pop: each prefix
// holds of every cell the prefix that the cell draws by itself where all are equally far away.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/cook/merge_parts.h"
#include "plugins/vegetation/plant/pack.h"

namespace coppice {

// Of the cells' points the part has a quarter at most: from farther away than cells are drawn for their own sake a view
// seldom asks for more, and where it does, cells are drawn.
inline constexpr float k_joined_points_share = 0.25f;

struct JoinedCells {
    PackedPart part{};  // ranges by count alone
    std::vector<PackedVertex> points;
    std::vector<uint32_t> point_owners;
    std::vector<PackedVertex> line_vertices;
};

// cells: as packed, with their ranges in packed.triangle_vertices, points and line_vertices, and with their common
// coverage gain; meshes: what they were packed from. Requires one cell at least. Pure, ties by cell.
JoinedCells join_cells(const PlantBlocks& packed, std::span<const CookPart> meshes);

}  // namespace coppice
