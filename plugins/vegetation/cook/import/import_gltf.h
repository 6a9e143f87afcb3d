// glTF 2.0 (.gltf, .glb) from any tool to a plant description: what the cook takes in.
//
// A material is a part, named after it (else after its mesh); materials of one name are one part. `extras` of
// a node, mesh or material, the former winning, may say {"coppice": {"kind": "points" | "lines",
// "importance": 2.0, "leaf": true}}. Where nothing says whether a part is a leaf, the first of these that
// answers decides:
//   1. the material's name, then the mesh's, then the node's: leaf, leav, needle, petal, flower, blossom,
//   grass, frond,
//      fern, foliage in it: yes; bark, trunk, branch, stem, stalk, twig, wood, root in it: no
//   2. alpha mode MASK or BLEND: yes
//   3. doubleSided
// Alpha-masked cards are cut along their outline (alpha_cut.h); textures become vertex colours
// (average_colors.h). Metres, y up, the author's origin. Read: KHR_mesh_quantization,
// EXT_meshopt_compression, KHR_texture_transform, EXT_mesh_gpu_instancing, EXT_texture_webp, KHR_materials_*
// (the base colour). Animation and morph targets are left out.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include "plugins/images/images.h"
#include "plugins/vegetation/cook/import/alpha_cut.h"
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/result.h"

namespace coppice {

struct ImportSettings {
    const ImagesInterface* images = nullptr;  // only files with base-colour textures need it
    AlphaCutSettings alpha_cut;
    float texture_detail_m = 0.02f;           // opaque textured triangles with longer edges are divided,
    uint32_t added_triangle_limit = 20'000;   // as far as this many more triangles allow
    size_t triangle_limit = size_t(1) << 25;  // of the plant
    size_t vertex_limit =
        size_t(1) << 26;  // of the plant, without those no triangle uses; and of any one mesh
    uint64_t size_limit_bytes = uint64_t(1) << 30;  // of the file and its buffers
};

// Same file, same result, on any number of threads. Errors: file_*, syntax, format_unknown,
// value_out_of_range, limit_exceeded, name_unknown; place is the glTF path, such as "accessors[3]" or
// "meshes[0].primitives[1]".
Result<PlantDescription> import_gltf(const std::string& path, const ImportSettings& settings);
// name: for messages and as the plant's name; base_dir: where relative URIs start.
Result<PlantDescription> import_gltf_memory(std::span<const std::byte> bytes, const std::string& name,
                                            const std::string& base_dir, const ImportSettings& settings);

}  // namespace coppice
