// What a glTF 2.0 file says, as plain structs: every index inside its array, every number finite and in its
// range, the node hierarchy a forest. Buffers are not touched here. The JSON is read directly: tinygltf 2.7.0
// checks neither indices nor numbers, so each of its values would have to be checked again, without the place
// it stood at. Source: Khronos glTF 2.0 specification and the extensions named below.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice {

inline constexpr uint32_t k_gltf_none = UINT32_MAX;  // in place of an index
inline constexpr uint32_t k_gltf_byte = 5120, k_gltf_ubyte = 5121, k_gltf_short = 5122, k_gltf_ushort = 5123,
                          k_gltf_uint = 5125, k_gltf_float = 5126;

struct GltfBuffer {
    std::optional<std::string> uri;  // none: the GLB's binary chunk, or a fallback nobody reads
    uint64_t size_bytes = 0;
};

// EXT_meshopt_compression
struct GltfMeshopt {
    enum class Mode : uint8_t { attributes, triangles, indices };
    enum class Filter : uint8_t { none, octahedral, quaternion, exponential };
    uint32_t buffer = 0;
    uint64_t offset_bytes = 0, size_bytes = 0;
    uint32_t stride_bytes = 0;
    uint64_t count = 0;
    Mode mode = Mode::attributes;
    Filter filter = Filter::none;
};

struct GltfBufferView {
    uint32_t buffer = 0;
    uint64_t offset_bytes = 0, size_bytes = 0;
    uint32_t stride_bytes = 0;  // 0: packed
    std::optional<GltfMeshopt> meshopt;
};

struct GltfSparse {
    uint64_t count = 0;
    uint32_t indices_view = 0, indices_type = 0;
    uint64_t indices_offset_bytes = 0;
    uint32_t values_view = 0;
    uint64_t values_offset_bytes = 0;
};

struct GltfAccessor {
    uint32_t view = k_gltf_none;  // none: zeros
    uint64_t offset_bytes = 0;
    uint64_t count = 0;
    uint32_t component_type = k_gltf_float;
    uint32_t components = 1;  // 1 to 4; matrices 4, 9, 16
    bool normalized = false;
    std::optional<GltfSparse> sparse;
};

enum class GltfWrap : uint8_t { repeat, mirror, clamp };

struct GltfImage {
    std::string name;
    std::optional<std::string> uri;
    uint32_t view = k_gltf_none;
};

struct GltfTexture {
    uint32_t image = k_gltf_none;  // none: only in a format we do not read
    GltfWrap wrap_s = GltfWrap::repeat, wrap_t = GltfWrap::repeat;
};

// A texture of a material with KHR_texture_transform.
struct GltfTextureUse {
    uint32_t texture = k_gltf_none;
    uint32_t texcoord = 0;
    vec2 offset{0, 0}, scale{1, 1};
    float rotation_rad = 0;
};

// extras: {"coppice": {"kind": "points" | "lines", "importance": 2.0, "leaf": true}} of a material, mesh or
// node.
struct GltfHints {
    std::optional<PartKind> kind;
    std::optional<float> importance;
    std::optional<bool> leaf;
};

struct GltfMaterial {
    std::string name;
    vec4 base_color_linear{1, 1, 1, 1};
    GltfTextureUse base_texture;
    bool masked = false;  // MASK, or BLEND, which is cut at one half
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    GltfHints hints;
};

struct GltfPrimitive {
    enum class Mode : uint8_t { triangles, strip, fan, other };
    Mode mode = Mode::triangles;
    uint32_t position = k_gltf_none, normal = k_gltf_none, color = k_gltf_none, indices = k_gltf_none;
    std::vector<uint32_t> texcoords;  // accessor of TEXCOORD_n
    uint32_t material = k_gltf_none;
    bool draco = false;
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;
    GltfHints hints;
};

// EXT_mesh_gpu_instancing
struct GltfInstancing {
    uint32_t translation = k_gltf_none, rotation = k_gltf_none, scale = k_gltf_none;
};

struct GltfNode {
    std::string name;
    mat4 local{1.0f};
    uint32_t mesh = k_gltf_none;
    uint32_t skin = k_gltf_none;
    std::vector<uint32_t> children;
    std::optional<GltfInstancing> instancing;
    GltfHints hints;
};

struct GltfSkin {
    std::vector<uint32_t> joints;  // nodes, at least one
    uint32_t inverse_bind_matrices = k_gltf_none;
};

struct GltfDocument {
    std::string file;  // as the user named it, for messages
    std::vector<GltfBuffer> buffers;
    std::vector<GltfBufferView> views;
    std::vector<GltfAccessor> accessors;
    std::vector<GltfImage> images;
    std::vector<GltfTexture> textures;
    std::vector<GltfMaterial> materials;
    std::vector<GltfMesh> meshes;
    std::vector<GltfNode> nodes;
    std::vector<GltfSkin> skins;
    std::vector<uint32_t>
        roots;  // nodes of the default scene, else of the first, else all that have no parent
};

// json: the whole text; file: for messages. Errors: syntax, format_unknown (not glTF 2, an unknown required
// extension), value_out_of_range, limit_exceeded (nesting), name_unknown (extras).
Result<GltfDocument> parse_gltf(std::string_view json, const std::string& file);

}  // namespace coppice
