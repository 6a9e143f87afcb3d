// A crown thinned by drop and resize, to compare with joined leaves: how far its coverage is off by each law of growth.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"
#include "tools/foliage/crown_coverage.h"

namespace coppice {

// Half the leaves' area over what the ellipsoid about the crown shows, in the mean of three sides; 0 without leaves.
float optical_depth(std::span<const Leaf> crown);

// In the order given, which drops its first, what stays of it at a share of the leaves: each longer and wider by `growth`
// about its middle.
std::vector<Leaf> thin_crown(std::span<const Leaf> crown, std::span<const uint32_t> drop_order, float share,
                             float growth);

struct DroppedErrors {
    uint32_t leaf_count = 0;
    // In progressive order along a curve through the crown.
    double unscaled = 0.0, half = 0.0, whole = 0.0;  // w = 0, 0.5, 1
    double tolerant = 0.0;                           // of a fiftieth of the coverage
    // w = 1, in golden-section order: as ours, and with its places in a cylinder, as printed.
    double whole_golden = 0.0, whole_printed = 0.0;
};

// At 1 / 2, 1 / 4, 1 / 8 and 1 / 20 of the leaves: CrownCoverage::worst_error of each.
std::vector<DroppedErrors> measure_dropped(std::span<const Leaf> crown, const CrownCoverage& coverage);

}  // namespace coppice
