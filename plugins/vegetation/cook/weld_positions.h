// Vertices at the same place (bit for bit) are one corner of the surface, however often normals or texture
// seams repeat them: connectedness is asked of the welded mesh.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

// For each vertex the first vertex at its position. -0 and 0 are one position. Requires finite positions.
std::vector<uint32_t> weld_positions(const std::vector<DescriptionVertex>& vertices);

}  // namespace coppice
