// Which places on the ground a parent joins: a tree over them, quarters of squares; and the space that such a parent has.
// Tiles of a scene become a tree by it, and so do the trees of packs that were made apart.
#pragma once
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

struct GroupNode {
    uint32_t first_child = 0, child_count = 0;  // nodes; none: a leaf
    uint32_t place = UINT32_MAX;                // of a leaf
};

struct Groups {
    std::vector<GroupNode> nodes;        // the root is node 0; none where there is no place
    std::vector<size_t> level_begin{0};  // breadth first: level i is [level_begin[i], level_begin[i + 1])
};

// A node's 2 to 8 children lie beside each other on the ground and follow each other. Heights are not looked at.
Groups group_places(std::span<const dvec3> places);

// What a parent's children fill.
struct JoinedSpace {
    dvec3 origin;  // rounded to 1/16 m, as tiles' origins are: differences of origins then are exact
    Box bounds;    // relative to the origin; a float's rounding lets nothing stick out
};

// Requires one box an origin, relative to it, and at least one.
JoinedSpace join_spaces(std::span<const dvec3> origins, std::span<const Box> bounds);

}  // namespace coppice
