// Vertices at the same place (bit for bit) are one corner of the surface, however often normals or texture
// seams repeat them: connectedness is asked of the welded mesh.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

// For each vertex the first vertex within two millionths of the mesh's extent that stands for itself: a seam
// whose two sides were computed with different roundings (cos 0 and cos 2 pi) is closed. Requires finite
// positions.
std::vector<uint32_t> weld_positions(const std::vector<DescriptionVertex>& vertices);

}  // namespace coppice
