// Vertex colours that show a texture: each vertex takes the mean of the opaque texels around it, weighted
// with the vertex's own share (its linear hat). Since the hats of a triangle sum to one, the mean colour of
// the mesh is the mean of the texture on it, however coarse the mesh: levels of detail never change the mean.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/cook/import/texture_pyramid.h"

namespace coppice {

// indices: three a triangle, into uvs. Returns one linear colour a vertex; a vertex without opaque texels
// around it takes the nearest there are.
std::vector<vec3> average_colors(const TexturePyramid& texture, std::span<const vec2> uvs,
                                 std::span<const uint32_t> indices);

}  // namespace coppice
