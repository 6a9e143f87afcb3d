// All levels of a crown in one list that no level changes: nothing is extracted, nothing uploaded, and plants of one model
// at different levels share all of it. Leaves stand in the order in which they are removed, so those of level c lie
// behind the first 2 c, among as many again at most that are not yet born; whoever draws skips those by their number.
// Ours, in place of LoDF's clusters (leaf_forest.h).
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

struct LeafLifetimes {
    uint32_t leaf_count = 0;  // of the full crown
    uint32_t collapse_count = 0;
    std::vector<uint32_t> leaves;  // numbers, by the collapse that removes them; then those that stay

    // Of level `level` at most collapse_count: draw those for which is_born.
    std::span<const uint32_t> candidates(uint32_t level) const {
        return std::span(leaves).subspan(2 * size_t(level));
    }
    bool is_born(uint32_t leaf, uint32_t level) const { return level_of_birth(leaf, leaf_count) <= level; }
    double words_per_vertex() const;  // as LeafForest's
};

// Requires collapses that check_collapses passes.
LeafLifetimes order_by_removal(uint32_t leaf_count, std::span<const LeafCollapse> collapses);

}  // namespace coppice
