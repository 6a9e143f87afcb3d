// All leaves of a plant as quads, at every level to which they are joined.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/lod/leaf_lifetimes.h"
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

// Of all parts that are leaves, in their order. Errors: clean_mesh's; value_out_of_range where there are fewer than two
// leaves.
Result<std::vector<Leaf>> find_crown(const PlantDescription& plant);

class Crown {
  public:
    // collapses: of these leaves.
    Crown(std::vector<Leaf> leaves, std::vector<LeafCollapse> collapses);

    // Level at most collapses().size(): that many leaves fewer. In the order in which they are removed.
    std::vector<Leaf> leaves_at(uint32_t level) const;
    // The level with that many leaves, or the coarsest where all have more.
    uint32_t level_of(uint32_t leaf_count) const;

    std::span<const Leaf> leaves() const { return leaves_; }
    std::span<const LeafCollapse> collapses() const { return collapses_; }
    const LeafLifetimes& lifetimes() const { return lifetimes_; }

  private:
    std::vector<Leaf> leaves_;
    std::vector<LeafCollapse> collapses_;
    LeafLifetimes lifetimes_;
};

// Of all, m2.
double crown_area_m2(std::span<const Leaf> leaves);

}  // namespace coppice
