// A tree's bark in one piece has trunk and twigs. Each should become lines at its own distance, so the part
// is split into octaves of thickness: "bark", "bark/2", "bark/4" ...
#pragma once
#include <vector>
#include "plugins/vegetation/cook/trace_skeleton.h"

namespace coppice {

struct SlenderPart {
    PartDescription part;
    TracedSkeleton skeleton;
};

// One part where the radii (1st to 99th percentile by area) differ by less than a factor of 3, else up to 4;
// no piece but the thickest has fewer than 64 triangles or 2 % of them. Triangles and segments are shared
// out, none is lost.
std::vector<SlenderPart> split_by_thickness(SlenderPart whole);

}  // namespace coppice
