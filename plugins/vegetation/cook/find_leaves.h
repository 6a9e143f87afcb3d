// The leaves of a part, each as a quad: what the author or modeller told apart, else what hangs together.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

// quads + triangles + meshes = leaves.
struct LeafCounts {
    uint32_t quads = 0;               // two triangles with a common edge: as published
    uint32_t triangles = 0;           // a single one
    uint32_t meshes = 0;              // anything else: a proxy (proxy_quad.h)
    uint32_t closed = 0;              // of the meshes those with an inside, of which half the area counts
    uint32_t repeated_triangles = 0;  // left out: a leaf's back as a second face, or the same leaf twice
    uint32_t repeated_leaves = 0;     // of which nothing else was left
    uint32_t largest_leaf_triangles = 0;
};

struct FoundLeaves {
    std::vector<Leaf> leaves;  // by their first triangle
    LeafCounts counts;
};

// welded: weld_positions of the part's vertices. Triangles with the same three welded corners are one surface, however
// often and whichever way they are listed. Requires a clean mesh (clean_mesh.h). Pure.
FoundLeaves find_leaves(const PartDescription& part, const std::vector<uint32_t>& welded);

}  // namespace coppice
