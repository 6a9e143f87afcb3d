// The leaves nearest to a place while leaves come and go: a balanced k-d tree whose entries are replaced in place.
// A leaf made of two takes the place of one of them, so the tree never grows; what searches is the boxes, which grow with
// their entries. Built anew when half are gone, it stays as quick as at first.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

class NearestLeaves {
  public:
    struct Entry {
        vec3 place;  // m, finite
        uint32_t leaf;
    };
    struct Neighbor {
        float distance_square_m2;
        uint32_t leaf;
        bool operator<(const Neighbor& other) const {
            return distance_square_m2 < other.distance_square_m2 ||
                   (distance_square_m2 == other.distance_square_m2 && leaf < other.leaf);
        }
    };

    // leaf_limit: more than any leaf's number.
    NearestLeaves(std::vector<Entry> entries, uint32_t leaf_limit);

    void remove(uint32_t leaf);
    void replace(uint32_t leaf, Entry by);
    uint32_t size() const { return nodes_.empty() ? 0 : nodes_[0].count; }
    std::vector<Entry> entries() const;  // those that are left

    // At most `count` others than `leaf`, nearest first, ties by number. Threads may search together.
    void find(vec3 place, uint32_t leaf, uint32_t count, std::vector<Neighbor>& neighbors) const;

  private:
    struct Node {
        Box box;
        uint32_t count;
    };
    void build(uint32_t node, uint32_t first, uint32_t last);
    void search(uint32_t node, vec3 place, uint32_t leaf, uint32_t count, std::vector<Neighbor>& heap) const;

    std::vector<Entry> entries_;
    std::vector<uint32_t> slot_of_;  // of a leaf, in entries_
    std::vector<Node> nodes_;        // a complete binary tree, children of i at 2 i + 1 and 2 i + 2
    std::vector<uint32_t> bucket_first_;
    std::vector<uint32_t> bucket_of_slot_;
    uint32_t bucket_count_ = 1;
};

}  // namespace coppice
