// Many levels of detail of one crown in clusters that change apart, so that a change of level touches and uploads only
// those in which something is joined or split. A cluster is one binary tree of collapses.
// Source: Rebollo et al. 2006 (LoDF), 3.1 to 3.3, Eq. 10 to 13. Deviates: their links give wrong leaves (ERRATA 7), so there
// are none. A cluster holds its leaves in the order in which they are removed: after k of its collapses its first 2 k are
// gone, which is Eq. 10 at every level; of the rest those are drawn that are born, which a leaf's number says (plant/leaf.h).
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

// Shared by all plants of the model. 3 words a leaf of the crown and 1 a cluster; see size_words.
struct LeafForest {
    uint32_t leaf_count = 0;              // L, of the full crown
    std::vector<uint32_t> cluster_first;  // into leaves; one more than there are clusters
    std::vector<uint32_t> leaves;  // numbers, cluster after cluster, each by the collapse that removes them
    std::vector<uint32_t> collapse_cluster;  // the paper's changed_group: in which cluster each collapse is

    uint32_t cluster_count() const { return uint32_t(cluster_first.size()) - 1; }
    uint32_t level_count() const { return uint32_t(collapse_cluster.size()) + 1; }
    // A cluster's leaves in the full crown: as many as it ever draws at once, and the length of its place on the device.
    uint32_t capacity(uint32_t cluster) const {
        return (cluster_first[cluster + 1] - cluster_first[cluster] + 1) / 2;
    }
    // Everything a level needs, in words of four bytes a corner of the crown: three for its place, and of each leaf made four
    // corners, growth and surface, of each leaf of the crown its surface; and this structure. The paper has 6.25.
    double words_per_vertex() const;
};

// Requires collapses that check_collapses passes. Clusters by their lowest leaf. O(L).
LeafForest grow_leaf_forest(uint32_t leaf_count, std::span<const LeafCollapse> collapses);

// One plant's level: 3 words a cluster. Starts with the full crown.
class ForestLevel {
  public:
    explicit ForestLevel(const LeafForest& forest);  // which must outlive it

    // Applies or takes back collapses until `level` of them are applied; more than there are is all of them. Returns the
    // clusters that changed, in the order of their first change, valid until the next call. O(steps).
    std::span<const uint32_t> move_to(uint32_t level);
    uint32_t level() const { return level_; }
    uint32_t active_count(uint32_t cluster) const {
        return forest_->capacity(cluster) - removed_pairs_[cluster];
    }

    // Writes the numbers of the cluster's leaves, active_count of them, and returns their end. At most twice as many are
    // looked at.
    uint32_t* list_active(uint32_t cluster, uint32_t* leaves) const;

  private:
    const LeafForest* forest_;
    uint32_t level_ = 0;
    std::vector<uint32_t> removed_pairs_;  // by cluster: collapses applied in it
    std::vector<uint32_t> seen_;           // by cluster: the call of move_to that last changed it
    std::vector<uint32_t> changed_;
    uint32_t call_ = 0;
};

}  // namespace coppice
