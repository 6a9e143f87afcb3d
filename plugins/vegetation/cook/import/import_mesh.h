// A triangle mesh on its way from glTF to a part: what textures still need to be applied to. Plant space.
#pragma once
#include <cstdint>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

struct ImportMesh {
    std::vector<vec3> positions_plant;
    std::vector<vec3> normals_plant;  // unit
    std::vector<vec3> colors_linear;  // base colour factor and vertex colours, textures not applied
    std::vector<vec2> uvs;            // texture transform applied; empty: no texture
    std::vector<uint32_t> indices;    // three a triangle
    std::vector<uint32_t>
        elements;  // of each triangle: which connected piece (one leaf, one card) it belongs to
    uint32_t element_count = 0;
    uint32_t dropped_vertices = 0;  // used by no triangle
    size_t triangle_count() const { return indices.size() / 3; }
};

}  // namespace coppice
