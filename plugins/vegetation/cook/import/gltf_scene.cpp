#include "plugins/vegetation/cook/import/gltf_scene.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include "plugins/vegetation/cook/import/compose_transform.h"
#include "plugins/vegetation/cook/import/gltf_accessor.h"

namespace coppice {
namespace {

std::string place_of(uint32_t node) { return "nodes[" + std::to_string(node) + "]"; }

bool is_finite(const mat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

// Parent before child, children in the order of the file.
std::vector<uint32_t> order_from(const GltfDocument& document, const std::vector<uint32_t>& roots) {
    std::vector<uint32_t> order, stack(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
        uint32_t node = stack.back();
        stack.pop_back();
        order.push_back(node);
        const auto& children = document.nodes[node].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    return order;
}

// World transforms of all nodes, also of those outside the scene: a skin may name them.
std::vector<mat4> world_transforms(const GltfDocument& document) {
    std::vector<uint8_t> is_child(document.nodes.size(), 0);
    for (const GltfNode& node : document.nodes)
        for (uint32_t child : node.children) is_child[child] = 1;
    std::vector<uint32_t> roots;
    for (uint32_t node = 0; node < document.nodes.size(); ++node)
        if (!is_child[node]) roots.push_back(node);
    std::vector<mat4> world(document.nodes.size(), mat4(1.0f));
    for (uint32_t root : roots) world[root] = document.nodes[root].local;
    for (uint32_t node : order_from(document, roots))
        for (uint32_t child : document.nodes[node].children)
            world[child] = world[node] * document.nodes[child].local;
    return world;
}

struct InstanceRow {
    std::vector<float> values;  // empty: not given
    uint64_t count = 0;
};

Result<InstanceRow> read_row(const GltfDocument& document, const GltfBuffers& buffers, uint32_t accessor,
                             uint32_t components, const std::string& place) {
    InstanceRow row;
    if (accessor == k_gltf_none) return row;
    if (document.accessors[accessor].components != components)
        return fail(ErrorId::value_out_of_range, document.file, place,
                    "an instance attribute of the wrong type",
                    "VEC3 translations and scales, VEC4 rotations");
    COPPICE_TRY(row.values, read_floats(document, buffers, accessor));
    row.count = document.accessors[accessor].count;
    return row;
}

Result<std::vector<mat4>> read_instances(const GltfDocument& document, const GltfBuffers& buffers,
                                         uint32_t node) {
    const GltfInstancing& many = *document.nodes[node].instancing;
    std::string place = place_of(node) + ".extensions.EXT_mesh_gpu_instancing";
    COPPICE_TRY(InstanceRow translation, read_row(document, buffers, many.translation, 3, place));
    COPPICE_TRY(InstanceRow rotation, read_row(document, buffers, many.rotation, 4, place));
    COPPICE_TRY(InstanceRow scale, read_row(document, buffers, many.scale, 3, place));
    uint64_t count = std::max({translation.count, rotation.count, scale.count});
    for (const InstanceRow* row : {&translation, &rotation, &scale})
        if (row->count != 0 && row->count != count)
            return fail(ErrorId::value_out_of_range, document.file, place,
                        "instance attributes of different counts", "one count for all of them");
    std::vector<mat4> transforms;
    transforms.reserve(count);
    for (uint64_t i = 0; i < count; ++i) {
        vec3 t(0.0f), s(1.0f);
        vec4 q(0, 0, 0, 1);
        for (int c = 0; c < 3 && translation.count; ++c) t[c] = translation.values[i * 3 + uint64_t(c)];
        for (int c = 0; c < 4 && rotation.count; ++c) q[c] = rotation.values[i * 4 + uint64_t(c)];
        for (int c = 0; c < 3 && scale.count; ++c) s[c] = scale.values[i * 3 + uint64_t(c)];
        transforms.push_back(compose_transform(t, q, s));
    }
    return transforms;
}

// A skinned mesh ignores its node's transform. At rest all of its joints move it alike, so the first one says
// where.
Result<mat4> rest_pose(const GltfDocument& document, const GltfBuffers& buffers,
                       const std::vector<mat4>& world, uint32_t skin_index) {
    const GltfSkin& skin = document.skins[skin_index];
    mat4 inverse_bind(1.0f);
    if (skin.inverse_bind_matrices != k_gltf_none) {
        if (document.accessors[skin.inverse_bind_matrices].components != 16)
            return fail(ErrorId::value_out_of_range, document.file,
                        "skins[" + std::to_string(skin_index) + "]", "inverseBindMatrices are not MAT4",
                        "an accessor of MAT4");
        COPPICE_TRY(auto values, read_floats(document, buffers, skin.inverse_bind_matrices));
        for (int i = 0; i < 16; ++i) inverse_bind[i / 4][i % 4] = values[size_t(i)];
    }
    return world[skin.joints[0]] * inverse_bind;
}

}  // namespace

Result<std::vector<GltfPlacement>> place_meshes(const GltfDocument& document, const GltfBuffers& buffers,
                                                size_t placement_limit) {
    std::vector<mat4> world = world_transforms(document);
    std::vector<GltfPlacement> placements;
    for (uint32_t index : order_from(document, document.roots)) {
        const GltfNode& node = document.nodes[index];
        if (node.mesh == k_gltf_none) continue;
        mat4 base = world[index];
        if (node.skin != k_gltf_none) {
            COPPICE_TRY(base, rest_pose(document, buffers, world, node.skin));
        }
        std::vector<mat4> instances{mat4(1.0f)};
        if (node.instancing) {
            COPPICE_TRY(instances, read_instances(document, buffers, index));
        }
        if (instances.size() > placement_limit - placements.size())
            return fail(ErrorId::limit_exceeded, document.file, place_of(index),
                        "too many instances of meshes",
                        "at most " + std::to_string(placement_limit) +
                            " in one plant; a scene of many plants is an eco file");
        for (const mat4& instance : instances) {
            placements.push_back({index, node.mesh, base * instance});
            if (!is_finite(placements.back().plant_from_mesh))
                return fail(ErrorId::value_out_of_range, document.file, place_of(index),
                            "a transform that is not finite",
                            "translations, rotations and scales of ordinary size");
        }
    }
    return placements;
}

namespace {

// Of rotations alone, by the largest of its four parts.
vec4 quaternion_of(const glm::dmat3& m) {
    const double xx = m[0][0], yy = m[1][1], zz = m[2][2];
    glm::dvec4 q;
    if (xx + yy + zz > 0.0)
        q = glm::dvec4(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0], 1.0 + xx + yy + zz);
    else if (xx > yy && xx > zz)
        q = glm::dvec4(1.0 + xx - yy - zz, m[0][1] + m[1][0], m[2][0] + m[0][2], m[1][2] - m[2][1]);
    else if (yy > zz)
        q = glm::dvec4(m[0][1] + m[1][0], 1.0 + yy - xx - zz, m[1][2] + m[2][1], m[2][0] - m[0][2]);
    else
        q = glm::dvec4(m[2][0] + m[0][2], m[1][2] + m[2][1], 1.0 + zz - xx - yy, m[0][1] - m[1][0]);
    return vec4(q / std::sqrt(glm::dot(q, q)));
}

// False where it has no size or is no number. What is sheared keeps its stem.
bool take_apart(const glm::dmat4& world, NamedPlace& place) {
    const dvec3 x(world[0]), y(world[1]), z(world[2]);
    const double volume = std::abs(glm::dot(glm::cross(x, y), z));
    place.at = dvec3(world[3]);
    place.scale = std::cbrt(volume);
    if (!(volume > 0.0 && std::isfinite(place.scale) && std::isfinite(place.at.x + place.at.y + place.at.z)))
        return false;
    const dvec3 up = y / glm::length(y);
    const dvec3 across = x - up * glm::dot(x, up), right = across / glm::length(across);
    place.turn = quaternion_of(glm::dmat3(right, up, glm::cross(right, up)));
    return std::isfinite(place.turn.x + place.turn.y + place.turn.z + place.turn.w);
}

}  // namespace

Result<std::vector<NamedPlaces>> place_nodes(const GltfDocument& document, const GltfBuffers& buffers,
                                             size_t place_limit) {
    std::vector<glm::dmat4> world(document.nodes.size(), glm::dmat4(1.0));
    std::vector<NamedPlaces> all;
    for (uint32_t root : document.roots) world[root] = glm::dmat4(document.nodes[root].local);
    for (uint32_t index : order_from(document, document.roots)) {
        const GltfNode& node = document.nodes[index];
        for (uint32_t child : node.children) world[child] = world[index] * glm::dmat4(document.nodes[child].local);
        if (!node.instancing && !node.children.empty()) continue;
        NamedPlaces named;
        named.place = place_of(index);
        if (!node.name.empty()) named.names.push_back(node.name);
        if (node.mesh != k_gltf_none && !document.meshes[node.mesh].name.empty())
            named.names.push_back(document.meshes[node.mesh].name);
        if (named.names.empty()) continue;
        std::vector<mat4> instances{mat4(1.0f)};
        if (node.instancing) {
            COPPICE_TRY(instances, read_instances(document, buffers, index));
        }
        if (instances.size() > place_limit)
            return fail(ErrorId::limit_exceeded, document.file, named.place, "too many nodes and instances",
                        "fewer in one file");
        place_limit -= instances.size();
        named.places.resize(instances.size());
        for (size_t i = 0; i < instances.size(); ++i)
            if (!take_apart(world[index] * glm::dmat4(instances[i]), named.places[i]))
                return fail(ErrorId::value_out_of_range, document.file, named.place,
                            node.instancing ? "instance " + std::to_string(i) + " has no size or no place"
                                            : "a transform without a size or a place",
                            "finite translations, and scales that are not 0");
        all.push_back(std::move(named));
    }
    return all;
}

}  // namespace coppice
