// Where the meshes of the default scene stand: the node hierarchy, GPU instances and the rest pose of skins
// resolved into one transform each.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/gltf_buffers.h"
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "plugins/vegetation/plant/named_places.h"

namespace coppice {

struct GltfPlacement {
    uint32_t node;
    uint32_t mesh;
    mat4 plant_from_mesh;
};

// In the order of the hierarchy, parents first. Errors: value_out_of_range (a transform that is not finite,
// instance attributes of different lengths), limit_exceeded (more than placement_limit).
Result<std::vector<GltfPlacement>> place_meshes(const GltfDocument& document, const GltfBuffers& buffers,
                                                size_t placement_limit);

// Where all nodes of the default scene stand that have no children, and all instances; each group by the names of node and
// mesh, if it has any. Errors: as place_meshes; value_out_of_range for what has no size.
Result<std::vector<NamedPlaces>> place_nodes(const GltfDocument& document, const GltfBuffers& buffers,
                                             size_t place_limit);

}  // namespace coppice
