#include "plugins/vegetation/cook/pack_leaves.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/cook/collapse_leaves.h"
#include "plugins/vegetation/cook/find_leaves.h"
#include "plugins/vegetation/cook/leaf_coverage.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "plugins/vegetation/plant/leaf_bands.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

PackedLeaf pack_leaf(const Leaf& leaf, uint32_t birth_level, const LeafGrid& grid, const Surface& surface,
                     uint32_t dither) {
    PackedLeaf packed{{}, encode_surface(surface, dither), birth_level};
    for (size_t k = 0; k < 4; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            const float steps =
                (leaf.corners_plant[k][axis] - grid.origin_plant[axis]) / grid.step_m[axis] + 0.5f;
            packed.corners[3 * k + size_t(axis)] = uint16_t(std::clamp(steps, 0.0f, 65535.0f));
        }
    return packed;
}

// The part's triangles, for LeafCoverage: a corner twice.
std::vector<Leaf> triangles_of(const PartDescription& part) {
    std::vector<Leaf> triangles(part.indices.size() / 3);
    for (size_t t = 0; t < triangles.size(); ++t)
        for (size_t k = 0; k < 4; ++k)
            triangles[t].corners_plant[k] =
                part.vertices[part.indices[3 * t + std::min<size_t>(k, 2)]].position_plant;
    return triangles;
}

std::vector<Leaf> leaves_of_level(std::span<const Leaf> crown, std::span<const LeafCollapse> collapses) {
    std::vector<bool> gone(crown.size() + collapses.size(), false);
    for (const LeafCollapse& collapse : collapses)
        for (uint32_t removed : collapse.removed) gone[removed] = true;
    std::vector<Leaf> leaves;
    leaves.reserve(crown.size() - collapses.size());
    for (size_t i = 0; i < gone.size(); ++i)
        if (!gone[i])
            leaves.push_back(i < crown.size() ? crown[i] : collapsed_leaf(crown, collapses[i - crown.size()]));
    return leaves;
}

// How many leaves the last level has that covers what the part does, as do those before it; 0: not even the first does.
uint32_t fewest_covering_leaves(const PartDescription& part, std::span<const Leaf> crown,
                                std::span<const LeafCollapse> collapses, float most_error) {
    constexpr double k_step = 0.70710678;  // half an octave
    const LeafCoverage truth(triangles_of(part));
    const uint32_t full = uint32_t(crown.size()), least = full - uint32_t(collapses.size());
    uint32_t covering = 0;
    for (uint32_t count = full;; count = std::max(uint32_t(k_step * double(count)), least)) {
        const CoverageExcess excess = truth.measure(leaves_of_level(crown, collapses.first(full - count)));
        if (!(std::fabs(excess.mean) <= most_error)) return covering;
        covering = count;
        if (count == least) return covering;
    }
}

}  // namespace

PackedLeaves pack_leaves(const PartDescription& part, const PackedPart& packed, const OpennessGrid& openness,
                         uint32_t dither_seed, float most_coverage_error) {
    const std::vector<Leaf> crown = find_leaves(part, weld_positions(part.vertices)).leaves;
    static_assert(k_most_packed_leaves <= k_most_crown_leaves);
    if (crown.size() < k_fewest_crown_leaves || crown.size() > k_most_packed_leaves) return {};
    const uint32_t full_count = uint32_t(crown.size());
    LeafCollapseSettings settings;
    settings.target_count = std::max(k_least_leaves, full_count / k_leaves_a_least_leaf);
    std::vector<LeafCollapse> collapses = collapse_leaves(crown, settings);
    const uint32_t covering = fewest_covering_leaves(part, crown, collapses, most_coverage_error);
    if (covering == 0) return {};
    collapses.resize(full_count - covering);
    PackedLeaves result{full_count, full_count - uint32_t(collapses.size()), {}};

    const uint32_t total = full_count + uint32_t(collapses.size());
    const LeafGrid grid = leaf_grid(packed);
    std::vector<PackedLeaf> leaves(total);
    parallel_for(total, 1024, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const Leaf leaf = i < full_count ? crown[i] : collapsed_leaf(crown, collapses[i - full_count]);
            vec3 middle(0);
            for (const vec3& corner : leaf.corners_plant) middle += corner * 0.25f;
            const Surface surface{leaf.normal_plant, leaf.color_linear, openness.at(middle), part.leaf};
            leaves[i] = pack_leaf(leaf, level_of_birth(uint32_t(i), full_count), grid, surface,
                                  mix_bits(uint32_t(i) ^ dither_seed));
        }
    });

    std::vector<bool> gone(total, false);
    result.leaves.reserve(banded_leaf_count(full_count, result.least_count));
    uint32_t level = 0;
    for (LeafBand band = first_band(full_count, result.least_count);; band = next_band(band, result.least_count)) {
        for (const uint32_t last_level = full_count - band.fewest; level < last_level; ++level)
            for (uint32_t removed : collapses[level].removed) {
                result.leaves.push_back(leaves[removed]);
                gone[removed] = true;
            }
        for (uint32_t i = 0; i < full_count + level; ++i)
            if (!gone[i]) result.leaves.push_back(leaves[i]);
        if (band.is_last(result.least_count)) return result;
    }
}

}  // namespace coppice
