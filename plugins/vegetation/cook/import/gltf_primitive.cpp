#include "plugins/vegetation/cook/import/gltf_primitive.h"

#include <algorithm>
#include "plugins/vegetation/cook/import/gltf_accessor.h"
#include "plugins/vegetation/plant/description.h"

namespace coppice {
namespace {

struct Reader {
    const GltfDocument& document;
    const GltfBuffers& buffers;
    const std::string& place;

    tl::unexpected<Error> bad(const std::string& where, std::string fault, std::string remedy) const {
        return fail(ErrorId::value_out_of_range, document.file, place + where, std::move(fault),
                    std::move(remedy));
    }

    Result<std::vector<float>> attribute(uint32_t accessor, const char* name, uint32_t least_components,
                                         uint32_t most_components, uint64_t vertex_count) const {
        const GltfAccessor& a = document.accessors[accessor];
        std::string where = std::string(".attributes.") + name;
        if (a.components < least_components || a.components > most_components ||
            a.component_type == k_gltf_uint)
            return bad(where, "an accessor of the wrong type", "what glTF and KHR_mesh_quantization allow");
        if (a.count != vertex_count)
            return bad(where,
                       std::to_string(a.count) + " values for " + std::to_string(vertex_count) + " positions",
                       "as many as there are positions");
        return read_floats(document, buffers, accessor);
    }
};

vec3 vec3_at(const std::vector<float>& values, size_t i, size_t components) {
    return vec3(values[i * components], values[i * components + 1], values[i * components + 2]);
}

std::vector<uint32_t> unroll(const std::vector<uint32_t>& order, GltfPrimitive::Mode mode) {
    std::vector<uint32_t> triangles;
    size_t n = order.size();
    if (mode == GltfPrimitive::Mode::triangles) {
        triangles.assign(order.begin(), order.begin() + ptrdiff_t(n / 3 * 3));
        return triangles;
    }
    if (n < 3) return triangles;
    triangles.reserve((n - 2) * 3);
    for (size_t i = 0; i + 2 < n; ++i) {
        uint32_t corners[3] = {order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]};
        if (mode == GltfPrimitive::Mode::fan)
            corners[0] = order[i + 1], corners[1] = order[i + 2], corners[2] = order[0];
        triangles.insert(triangles.end(), corners, corners + 3);
    }
    return triangles;
}

// Many primitives may share one large vertex buffer, and each place of a mesh copies it.
void drop_unused_vertices(ImportMesh& mesh) {
    constexpr uint32_t k_unused = UINT32_MAX;
    std::vector<uint32_t> new_index(mesh.positions_plant.size(), k_unused);
    for (uint32_t index : mesh.indices) new_index[index] = 0;
    uint32_t kept = 0;
    for (uint32_t& index : new_index)
        if (index != k_unused) index = kept++;
    mesh.dropped_vertices = uint32_t(new_index.size()) - kept;
    if (mesh.dropped_vertices == 0) return;
    auto compact = [&]<class T>(std::vector<T>& values) {
        if (values.empty()) return;
        std::vector<T> used(kept);
        for (size_t v = 0; v < values.size(); ++v)
            if (new_index[v] != k_unused) used[new_index[v]] = values[v];
        values = std::move(used);
    };
    compact(mesh.positions_plant);
    compact(mesh.normals_plant);
    compact(mesh.colors_linear);
    compact(mesh.uvs);
    for (uint32_t& index : mesh.indices) index = new_index[index];
}

// Every triangle gets its own three vertices and its own normal.
ImportMesh make_flat(const ImportMesh& mesh) {
    ImportMesh flat;
    flat.dropped_vertices = mesh.dropped_vertices;
    size_t count = mesh.indices.size();
    flat.positions_plant.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        uint32_t v = mesh.indices[i];
        flat.positions_plant.push_back(mesh.positions_plant[v]);
        flat.colors_linear.push_back(mesh.colors_linear[v]);
        if (!mesh.uvs.empty()) flat.uvs.push_back(mesh.uvs[v]);
        flat.indices.push_back(uint32_t(i));
    }
    flat.normals_plant.resize(count);
    for (size_t i = 0; i + 2 < count; i += 3) {
        const vec3* p = &flat.positions_plant[i];
        vec3 normal = normalize_or(glm::cross(p[1] - p[0], p[2] - p[0]), vec3(0, 1, 0));
        for (size_t c = 0; c < 3; ++c) flat.normals_plant[i + c] = normal;
    }
    return flat;
}

vec2 transform_uv(vec2 uv, const GltfTextureUse& use, float sine, float cosine) {
    uv = uv * use.scale;
    return vec2(cosine * uv.x + sine * uv.y, -sine * uv.x + cosine * uv.y) + use.offset;
}

}  // namespace

Result<ImportMesh> read_primitive_mesh(const GltfDocument& document, const GltfBuffers& buffers,
                                       const GltfPrimitive& primitive, const std::string& place,
                                       size_t triangle_limit, size_t vertex_limit) {
    Reader reader{document, buffers, place};
    ImportMesh mesh;
    if (primitive.mode == GltfPrimitive::Mode::other) return mesh;
    if (primitive.draco)
        return fail(ErrorId::format_unknown, document.file, place, "the mesh is compressed with Draco",
                    "export it without KHR_draco_mesh_compression; EXT_meshopt_compression is read");
    if (primitive.position == k_gltf_none) return reader.bad(".attributes", "no POSITION", "positions");

    uint64_t vertex_count = document.accessors[primitive.position].count;
    uint64_t corner_count =
        primitive.indices == k_gltf_none ? vertex_count : document.accessors[primitive.indices].count;
    uint64_t triangle_count = primitive.mode == GltfPrimitive::Mode::triangles ? corner_count / 3
                              : corner_count > 2                               ? corner_count - 2
                                                                               : 0;
    if (triangle_count > triangle_limit)
        return fail(ErrorId::limit_exceeded, document.file, place,
                    "too many triangles: " + std::to_string(triangle_count),
                    "at most " + std::to_string(triangle_limit) + " more in this plant");
    if (vertex_count > vertex_limit)
        return fail(ErrorId::limit_exceeded, document.file, place, std::to_string(vertex_count) + " vertices",
                    "at most " + std::to_string(vertex_limit));
    COPPICE_TRY(auto positions, reader.attribute(primitive.position, "POSITION", 3, 3, vertex_count));
    mesh.positions_plant.resize(vertex_count);
    for (size_t i = 0; i < vertex_count; ++i) mesh.positions_plant[i] = vec3_at(positions, i, 3);

    vec3 factor(1.0f);
    const GltfTextureUse* use = nullptr;
    if (primitive.material != k_gltf_none) {
        const GltfMaterial& material = document.materials[primitive.material];
        factor = vec3(material.base_color_linear);
        if (material.base_texture.texture != k_gltf_none) use = &material.base_texture;
    }
    mesh.colors_linear.assign(vertex_count, factor);
    if (primitive.color != k_gltf_none) {
        COPPICE_TRY(auto colors, reader.attribute(primitive.color, "COLOR_0", 3, 4, vertex_count));
        size_t components = document.accessors[primitive.color].components;
        for (size_t i = 0; i < vertex_count; ++i)
            mesh.colors_linear[i] *= glm::clamp(vec3_at(colors, i, components), vec3(0.0f), vec3(1.0f));
    }
    if (use) {
        if (use->texcoord >= primitive.texcoords.size())
            return reader.bad(".attributes",
                              "the material's texture needs TEXCOORD_" + std::to_string(use->texcoord),
                              "texture coordinates");
        uint32_t accessor = primitive.texcoords[use->texcoord];
        COPPICE_TRY(auto uvs, reader.attribute(accessor, "TEXCOORD", 2, 2, vertex_count));
        float sine = portable_sin(use->rotation_rad), cosine = portable_cos(use->rotation_rad);
        mesh.uvs.resize(vertex_count);
        for (size_t i = 0; i < vertex_count; ++i) {
            mesh.uvs[i] = transform_uv(vec2(uvs[i * 2], uvs[i * 2 + 1]), *use, sine, cosine);
            if (!(glm::dot(mesh.uvs[i], mesh.uvs[i]) < 1.0e8f))
                return reader.bad(".attributes.TEXCOORD_" + std::to_string(use->texcoord),
                                  "texture coordinate " + std::to_string(i) + " is far outside its texture",
                                  "coordinates within 10000 repeats");
        }
    }
    std::vector<uint32_t> order;
    if (primitive.indices != k_gltf_none) {
        COPPICE_TRY(order, read_indices(document, buffers, primitive.indices));
        for (size_t i = 0; i < order.size(); ++i)
            if (order[i] >= vertex_count)
                return reader.bad(".indices",
                                  "index " + std::to_string(order[i]) + " at " + std::to_string(i) +
                                      ", but there are " + std::to_string(vertex_count) + " vertices",
                                  "indices below the number of vertices");
    } else {
        order.resize(vertex_count);
        for (size_t i = 0; i < vertex_count; ++i) order[i] = uint32_t(i);
    }
    mesh.indices = unroll(order, primitive.mode);

    if (primitive.normal == k_gltf_none) {
        drop_unused_vertices(mesh);
        return make_flat(mesh);
    }
    COPPICE_TRY(auto normals, reader.attribute(primitive.normal, "NORMAL", 3, 3, vertex_count));
    mesh.normals_plant.resize(vertex_count);
    for (size_t i = 0; i < vertex_count; ++i)
        mesh.normals_plant[i] = normalize_or(vec3_at(normals, i, 3), vec3(0, 1, 0));
    drop_unused_vertices(mesh);
    return mesh;
}

Result<ImportMesh> transform_mesh(const ImportMesh& mesh, const mat4& plant_from_mesh,
                                  const std::string& file, const std::string& place) {
    ImportMesh placed = mesh;
    mat3 linear(plant_from_mesh);
    // Normals go with the cofactors: the inverse transpose without its division, so flat scales work as well.
    mat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                  glm::cross(linear[0], linear[1]));
    bool mirrored = glm::dot(linear[0], cofactor[0]) < 0.0f;
    if (mirrored) cofactor = cofactor * -1.0f;
    for (size_t i = 0; i < placed.positions_plant.size(); ++i) {
        vec3& p = placed.positions_plant[i];
        p = vec3(plant_from_mesh * vec4(p, 1.0f));
        if (!is_finite(p) || std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > k_position_limit_m)
            return fail(ErrorId::value_out_of_range, file, place,
                        "position " + std::to_string(i) + " is out of range",
                        "metres, at most 100 km from the origin");
        vec3& n = placed.normals_plant[i];
        n = normalize_or(cofactor * n, n);
    }
    if (mirrored)
        for (size_t i = 0; i + 2 < placed.indices.size(); i += 3)
            std::swap(placed.indices[i + 1], placed.indices[i + 2]);
    return placed;
}

}  // namespace coppice
