// Leaf outlines as small meshes, folded along the midrib and curved from foot to tip: leaves are geometry, so
// that they look right near and their area is true in the distance.
#pragma once
#include <array>
#include <cstdint>
#include <vector>
#include "plugins/modeller/species.h"
#include "runtime/core/math.h"

namespace coppice::modeller {

// A leaf of length 1 in the frame (across, along, upper side), its foot at the origin.
struct LeafMesh {
    std::vector<vec3> positions;  // x across, y along, z out of the upper side
    std::vector<vec3> normals;    // unit, smooth
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<float> along;  // 0 at the foot, 1 at the tip, before curving
    std::vector<float> edge;   // 0 on the midrib, 1 on the outline
};

// width_ratio: width by length. Not for needles, which have no one mesh.
LeafMesh make_leaf_mesh(LeafShape shape, float width_ratio, float fold_rad, float curve_rad);

uint32_t triangles_of_leaf(LeafShape shape, uint32_t needles);

}  // namespace coppice::modeller
