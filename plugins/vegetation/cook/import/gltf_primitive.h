// One primitive of a mesh at one place: attributes checked against each other, strips and fans unrolled,
// missing normals made (flat, as the specification asks), mirrored transforms turned so that fronts stay
// fronts.
#pragma once
#include <cstdint>
#include <memory>
#include "plugins/vegetation/cook/import/gltf_buffers.h"
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "plugins/vegetation/cook/import/import_mesh.h"

namespace coppice {

// In mesh space, vertices no triangle uses dropped and counted. Points and lines give an empty mesh; the
// caller says so. place: "meshes[2].primitives[0]". The limits are checked before anything is allocated.
// Errors: value_out_of_range, format_unknown (Draco), limit_exceeded.
Result<ImportMesh> read_primitive_mesh(const GltfDocument& document, const GltfBuffers& buffers,
                                       const GltfPrimitive& primitive, const std::string& place,
                                       size_t triangle_limit, size_t vertex_limit);

// Errors: value_out_of_range where a position leaves what a float holds.
Result<ImportMesh> transform_mesh(const ImportMesh& mesh, const mat4& plant_from_mesh,
                                  const std::string& file, const std::string& place);

}  // namespace coppice
