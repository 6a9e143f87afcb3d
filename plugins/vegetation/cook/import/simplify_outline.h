// Fewer corners for outlines, every area kept: two neighbouring corners become one, placed so that what the
// outline gains on one side it loses on the other. No two pieces of outline ever come to cross, and nothing
// changes sides. Source: Kronenfeld et al. 2020, "Simplification of polylines by segment collapse: minimizing
// areal displacement while preserving area". Deviates: one queue for all rings; rings of three corners may
// vanish whole, and what area that costs is made up for by moving all outlines in or out by a fraction of a
// texel.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/trace_outline.h"

namespace coppice {

struct OutlineLimits {
    double displaced_area = 0.0;  // sum over all collapses, in the square unit of the corners
    size_t corner_count =
        0;            // collapses go on beyond displaced_area until no more corners are left than this
    dvec2 low, high;  // corners stay inside this box
};

// rings: as trace_outline gives them; they may not cross. Order of the rings is kept.
std::vector<Ring> simplify_outline(const std::vector<Ring>& rings, const OutlineLimits& limits);

}  // namespace coppice
