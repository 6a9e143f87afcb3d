#include "plugins/vegetation/lod/leaf_forest.h"

#include <algorithm>

namespace coppice {

double LeafForest::words_per_vertex() const {
    const double crown = leaf_count, made = double(collapse_cluster.size());
    const double geometry = 12.0 * crown + crown + 6.0 * made;
    return (geometry + double(leaves.size() + collapse_cluster.size() + cluster_first.size())) /
           std::max(4.0 * crown, 1.0);
}

LeafForest grow_leaf_forest(uint32_t leaf_count, std::span<const LeafCollapse> collapses) {
    constexpr uint32_t k_none = UINT32_MAX;
    const uint32_t total = leaf_count + uint32_t(collapses.size());
    // A leaf made is the root of its cluster until it is removed: numbers fall towards the crown's own.
    std::vector<uint32_t> cluster(total, k_none);
    std::vector<uint32_t> parent(total, k_none);
    for (uint32_t i = 0; i < collapses.size(); ++i)
        for (uint32_t removed : collapses[i].removed) parent[removed] = leaf_count + i;
    std::vector<uint32_t> root(total);
    for (uint32_t leaf = total; leaf-- > 0;) root[leaf] = parent[leaf] == k_none ? leaf : root[parent[leaf]];

    LeafForest forest;
    forest.leaf_count = leaf_count;
    forest.cluster_first.push_back(0);
    for (uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
        uint32_t& number = cluster[root[leaf]];
        if (number == k_none) {
            number = uint32_t(forest.cluster_first.size()) - 1;
            forest.cluster_first.push_back(0);
        }
    }
    for (uint32_t leaf = 0; leaf < total; ++leaf) ++forest.cluster_first[cluster[root[leaf]] + 1];
    for (size_t c = 1; c < forest.cluster_first.size(); ++c)
        forest.cluster_first[c] += forest.cluster_first[c - 1];

    forest.leaves.resize(total);
    forest.collapse_cluster.reserve(collapses.size());
    std::vector<uint32_t> next(forest.cluster_first.begin(), forest.cluster_first.end() - 1);
    for (const LeafCollapse& collapse : collapses) {
        const uint32_t c = cluster[root[collapse.removed[0]]];
        forest.collapse_cluster.push_back(c);
        for (uint32_t removed : collapse.removed) forest.leaves[next[c]++] = removed;
    }
    for (uint32_t leaf = 0; leaf < total; ++leaf)
        if (parent[leaf] == k_none) forest.leaves[next[cluster[leaf]]++] = leaf;
    return forest;
}

ForestLevel::ForestLevel(const LeafForest& forest)
    : forest_(&forest), removed_pairs_(forest.cluster_count(), 0), seen_(forest.cluster_count(), 0) {}

std::span<const uint32_t> ForestLevel::move_to(uint32_t level) {
    level = std::min(level, forest_->level_count() - 1);
    changed_.clear();
    ++call_;
    auto change = [this](uint32_t collapse, uint32_t by) {
        const uint32_t cluster = forest_->collapse_cluster[collapse];
        removed_pairs_[cluster] += by;
        if (seen_[cluster] == call_) return;
        seen_[cluster] = call_;
        changed_.push_back(cluster);
    };
    while (level_ < level) change(level_++, 1);
    while (level_ > level) change(--level_, UINT32_MAX);
    return changed_;
}

uint32_t* ForestLevel::list_active(uint32_t cluster, uint32_t* leaves) const {
    const uint32_t last = forest_->cluster_first[cluster + 1];
    for (uint32_t i = forest_->cluster_first[cluster] + 2 * removed_pairs_[cluster]; i < last; ++i)
        if (level_of_birth(forest_->leaves[i], forest_->leaf_count) <= level_) *leaves++ = forest_->leaves[i];
    return leaves;
}

}  // namespace coppice
