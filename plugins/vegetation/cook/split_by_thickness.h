// A tree's bark in one piece has trunk and twigs. Each should become lines at its own distance, so the part
// is split into classes of thickness, a factor of four each: "bark", "bark/4", "bark/16". (Octaves gave twice
// the parts, each of which costs every instance a decision every frame, for lines that begin no earlier for
// most of the surface.)
#pragma once
#include <vector>
#include "plugins/vegetation/cook/trace_skeleton.h"

namespace coppice {

struct SlenderPart {
    PartDescription part;
    TracedSkeleton skeleton;
};

// One part where the radii (1st to 99th percentile by area) differ by less than a factor of 4, else up to 3;
// no piece but the thickest has fewer than 64 triangles or 5 % of them. Triangles and segments are shared
// out, none is lost.
std::vector<SlenderPart> split_by_thickness(SlenderPart whole);

}  // namespace coppice
