#include "plugins/vegetation/lod/leaf_lifetimes.h"

#include <algorithm>

namespace coppice {

double LeafLifetimes::words_per_vertex() const {
    const double crown = leaf_count;
    return (13.0 * crown + 6.0 * double(collapse_count) + double(leaves.size())) / std::max(4.0 * crown, 1.0);
}

LeafLifetimes order_by_removal(uint32_t leaf_count, std::span<const LeafCollapse> collapses) {
    LeafLifetimes lifetimes{leaf_count, uint32_t(collapses.size()), {}};
    std::vector<bool> removed(leaf_count + collapses.size(), false);
    lifetimes.leaves.reserve(removed.size());
    for (const LeafCollapse& collapse : collapses)
        for (uint32_t leaf : collapse.removed) {
            lifetimes.leaves.push_back(leaf);
            removed[leaf] = true;
        }
    for (uint32_t leaf = 0; leaf < removed.size(); ++leaf)
        if (!removed[leaf]) lifetimes.leaves.push_back(leaf);
    return lifetimes;
}

}  // namespace coppice
