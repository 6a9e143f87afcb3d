// Divides the long edges of textured meshes, so that vertex colours can carry the texture's detail. An edge
// is divided or not by its own lengths alone, on the plant and in the texture, so neighbours agree and no
// crack opens.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/import_mesh.h"

namespace coppice {

struct TexturedMesh {
    ImportMesh* mesh;
    vec2 texels;  // sides of its texture
};

// Down to edges of edge_m or of two texels, or to the shortest length that added_triangle_limit allows for
// all meshes together.
void divide_long_edges(const std::vector<TexturedMesh>& meshes, float edge_m, size_t added_triangle_limit);

}  // namespace coppice
