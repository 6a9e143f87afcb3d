// Where the nodes of a glTF file stand, for scenes of many plants: those without children, and all instances of
// EXT_mesh_gpu_instancing, by the names of node and mesh. No mesh is looked at.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>
#include "plugins/vegetation/plant/named_places.h"
#include "runtime/core/result.h"

namespace coppice {

inline constexpr size_t k_named_place_limit = 20'000'000;

// .gltf or .glb; of the default scene, in its order. Places are summed in double precision. Errors: file_*, parse_gltf's, those of
// buffers and accessors, limit_exceeded, value_out_of_range (a scale of 0).
Result<std::vector<NamedPlaces>> read_named_places(const std::string& path);
Result<std::vector<NamedPlaces>> read_named_places_memory(std::span<const std::byte> bytes, const std::string& name,
                                                          const std::string& base_dir, size_t size_limit_bytes);

}  // namespace coppice
