// Rings to triangles: holes joined to what surrounds them, ears cut, then edges turned until the triangles
// are as round as the outline allows (Delaunay), because each will carry one colour a corner.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/trace_outline.h"

namespace coppice {

struct FlatMesh {
    std::vector<dvec2> corners;
    std::vector<uint32_t> indices;  // three a triangle, counter-clockwise
};

// rings: outer ones positive, holes negative, none crossing another (simplify_outline). Triangles without
// area are left out; the sum of their areas is that of the rings.
FlatMesh triangulate_outline(const std::vector<Ring>& rings);

}  // namespace coppice
