// Joins leaves two by two, those first that lose least, so that a far crown keeps its area, its normals and its colour with
// fewer quads. Pure function: same input, same bytes, on any number of threads.
// Source: FSA (Remolar et al. 2002) as far as Rebollo et al. 2006 and ERRATA 8 tell. Deviates: leaf_error.h, join_leaves.h;
// every new leaf has the area of its two, so that every level has the crown's, unless that
// would cover more than the crown does however its leaves are bent (steer_coverage.h).
#pragma once
#include <vector>
#include "plugins/vegetation/cook/leaf_error.h"
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

struct LeafCollapseSettings {
    uint32_t target_count = 1;     // leaves to keep; 0 is 1
    float max_error_m = INFINITY;  // of one collapse
    float least_area = 0.3f;  // (0, 1]: what of its area a leaf may lose where coverage cannot be kept else
    LeafErrorWeights weights;
    uint32_t neighbor_count = 10;  // each leaf is compared with so many nearest ones; >= 1
};

// Collapse i makes leaf (leaf_count + i). Any prefix is a level of detail. Greedy: at each step the least error between
// neighbours, ties by number. Requires finite leaves with unit normals, fewer than 2^30. n log n; 0.6 KiB a leaf.
std::vector<LeafCollapse> collapse_leaves(std::span<const Leaf> crown, const LeafCollapseSettings& settings);

}  // namespace coppice
