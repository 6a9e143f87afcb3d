#include "plugins/vegetation/lod/view_dependent_foliage.h"

namespace coppice {

ViewDependentFoliage grow_view_dependent_foliage(uint32_t leaf_count,
                                                 std::span<const LeafCollapse> collapses) {
    ViewDependentFoliage foliage{leaf_count, {}, {}};
    std::vector<bool> removed(leaf_count + collapses.size(), false);
    for (const LeafCollapse& collapse : collapses) {
        foliage.children.push_back(collapse.removed);
        for (uint32_t leaf : collapse.removed) removed[leaf] = true;
    }
    for (uint32_t leaf = 0; leaf < removed.size(); ++leaf)
        if (!removed[leaf]) foliage.roots.push_back(leaf);
    return foliage;
}

void extract_leaves(const ViewDependentFoliage& foliage, uint32_t level, std::vector<uint32_t>& leaves) {
    leaves.clear();
    std::vector<uint32_t> open;
    for (uint32_t root : foliage.roots) {
        open.push_back(root);
        while (!open.empty()) {
            const uint32_t leaf = open.back();
            open.pop_back();
            if (level_of_birth(leaf, foliage.leaf_count) <= level) {
                leaves.push_back(leaf);
                continue;
            }
            const auto [first, second] = foliage.children[leaf - foliage.leaf_count];
            open.push_back(second);
            open.push_back(first);
        }
    }
}

}  // namespace coppice
