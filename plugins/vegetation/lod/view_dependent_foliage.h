// The baseline LoDF is measured against: at every change of level the trees of collapses are walked from their roots, and all
// leaves found are sent. Source: Remolar et al. 2003 (VDF) as far as Rebollo et al. 2006 and ERRATA 9 tell.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

struct ViewDependentFoliage {
    uint32_t leaf_count = 0;                        // of the full crown
    std::vector<std::array<uint32_t, 2>> children;  // of leaf leaf_count + i
    std::vector<uint32_t> roots;                    // ascending
};

// Requires collapses that check_collapses passes.
ViewDependentFoliage grow_view_dependent_foliage(uint32_t leaf_count,
                                                 std::span<const LeafCollapse> collapses);

// The leaves of a level, tree after tree. O(their number).
void extract_leaves(const ViewDependentFoliage& foliage, uint32_t level, std::vector<uint32_t>& leaves);

}  // namespace coppice
