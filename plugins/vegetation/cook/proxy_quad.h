// One quad for a leaf of any small mesh. A leaf of two triangles with a common edge is a quad as it stands, and one of a
// single triangle becomes one by a fourth corner on its longest edge: neither changes. Any other becomes a rhombus that
// keeps area, middle, normal and, in their ratio, the spread along and across it; a rhombus, because leaves have a tip. It is
// folded along or across as much as the leaf is bent that way: flat, it would cover more.
// Ours: FSA (Remolar et al. 2002) knows quads only.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

struct ProxyQuad {
    Leaf leaf;
    bool exact;  // the quad is the surface itself
};

// triangles: indices into the part's triangles, at least one. closed: the mesh has an inside, so that half of its area
// covers what all of it does. Normal and colour are means by area. Requires a clean mesh.
ProxyQuad fit_proxy_quad(const PartDescription& part, const std::vector<uint32_t>& welded,
                         std::span<const uint32_t> triangles, bool closed);

}  // namespace coppice
