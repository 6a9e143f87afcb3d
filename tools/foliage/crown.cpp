#include "tools/foliage/crown.h"

#include <algorithm>
#include <utility>
#include "plugins/vegetation/cook/clean_mesh.h"
#include "plugins/vegetation/cook/find_leaves.h"
#include "plugins/vegetation/cook/weld_positions.h"

namespace coppice {

Result<std::vector<Leaf>> find_crown(const PlantDescription& plant) {
    std::vector<Leaf> crown;
    for (const PartDescription& described : plant.parts) {
        if (!described.leaf) continue;
        CleanCounts counts;
        COPPICE_TRY(const PartDescription part, clean_mesh(described, plant.name, described.name, counts));
        const FoundLeaves found = find_leaves(part, weld_positions(part.vertices));
        crown.insert(crown.end(), found.leaves.begin(), found.leaves.end());
    }
    if (crown.size() < 2)
        return fail(ErrorId::value_out_of_range, plant.name, "leaves", "a plant with fewer than two leaves",
                    "name a plant that has parts of leaves, such as content/species/oak.json");
    return crown;
}

Crown::Crown(std::vector<Leaf> leaves, std::vector<LeafCollapse> collapses)
    : leaves_(std::move(leaves)),
      collapses_(std::move(collapses)),
      lifetimes_(order_by_removal(uint32_t(leaves_.size()), collapses_)) {}

std::vector<Leaf> Crown::leaves_at(uint32_t level) const {
    std::vector<Leaf> drawn;
    for (uint32_t leaf : lifetimes_.candidates(level)) {
        if (!lifetimes_.is_born(leaf, level)) continue;
        drawn.push_back(leaf < leaves_.size() ? leaves_[leaf]
                                              : collapsed_leaf(leaves_, collapses_[leaf - leaves_.size()]));
    }
    return drawn;
}

uint32_t Crown::level_of(uint32_t leaf_count) const {
    const uint32_t all = uint32_t(leaves_.size());
    return std::min(all - std::min(leaf_count, all), uint32_t(collapses_.size()));
}

double crown_area_m2(std::span<const Leaf> leaves) {
    double sum_m2 = 0.0;
    for (const Leaf& leaf : leaves) sum_m2 += leaf_area_m2(leaf);
    return sum_m2;
}

}  // namespace coppice
