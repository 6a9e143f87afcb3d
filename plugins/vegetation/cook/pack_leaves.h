// A part's crown as the packed plant holds it: its leaves, joined two by two, in bands (plant/leaf_bands.h).
#pragma once
#include <vector>
#include "plugins/vegetation/cook/openness.h"
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// Of a part that is worth a crown. One of more leaves is a large plant's, which is drawn in cells where a leaf is worth
// several points, and its levels would take 96 bytes a leaf for nothing.
inline constexpr uint32_t k_fewest_crown_leaves = 64, k_most_packed_leaves = 1u << 17;
// What a level may cover more or less than the part's triangles do, in the mean over directions. Small crowns of large tufts
// soon do, and points are better there.
inline constexpr float k_most_coverage_error = 0.015f;
// A crown's last level, if it gets there: from farther away points are better, and cover as much (decision 36).
inline constexpr uint32_t k_least_leaves = 16, k_leaves_a_least_leaf = 64;

struct PackedLeaves {
    uint32_t full_count = 0, least_count = 0;  // 0: not worth a crown
    std::vector<PackedLeaf> leaves;
};

// Levels end where the first is off by more than most_coverage_error, looked at twice an octave. packed: the part's bounds, within which the leaves stay. Requires a clean mesh (clean_mesh.h). Pure.
PackedLeaves pack_leaves(const PartDescription& part, const PackedPart& packed, const OpennessGrid& openness,
                         uint32_t dither_seed, float most_coverage_error = k_most_coverage_error);

}  // namespace coppice
