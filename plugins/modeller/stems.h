// Grows the wood of a tree as centre lines with radii: W&P's levels of stems with splits, curvature, down
// angles and rotation, shape ratio, pruning and attraction. No mesh yet. Source: Weber and Penn 1995,
// section 4. Deviates: README.md.
#pragma once
#include <string>
#include <vector>
#include "plugins/modeller/part_builder.h"
#include "plugins/modeller/species.h"
#include "runtime/core/random.h"

namespace coppice::modeller {

struct StemNode {
    vec3 position;
    Frame frame;
    float fraction;  // of the stem's whole length
    float radius_m;
};

struct Stem {
    uint32_t level;
    float length_m;         // whole, also of a stem that split off half-way
    float base_radius_m;    // before flare
    float parent_fraction;  // where it left its parent
    float relative_length;  // by its level's greatest, W&P's length_child_max
    float first_fraction;   // 0; of a split's clone where it began
    uint32_t first_node, node_count;
    Random random;
};

struct StemTree {
    std::vector<Stem> stems;  // level by level, parents before children
    std::vector<StemNode> nodes;
    float height_m;
};

// Scaled as a whole so that the highest node is at the height asked for. limit_exceeded where splits run
// away.
Result<StemTree> grow_stems(const TreeParameters& tree, const std::string& file, Random random);

// Position, frame and radius between two nodes. Fractions outside the stem are clamped.
StemNode node_at(const StemTree& tree, const Stem& stem, float fraction);

}  // namespace coppice::modeller
