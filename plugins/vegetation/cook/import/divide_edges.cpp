#include "plugins/vegetation/cook/import/divide_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coppice {
namespace {

float square_length(const ImportMesh& mesh, uint32_t a, uint32_t b) {
    vec3 d = mesh.positions_plant[a] - mesh.positions_plant[b];
    return glm::dot(d, d);
}

bool is_long(const TexturedMesh& textured, uint32_t a, uint32_t b, float square_limit) {
    vec2 texels = (textured.mesh->uvs[a] - textured.mesh->uvs[b]) * textured.texels;
    return square_length(*textured.mesh, a, b) > square_limit && glm::dot(texels, texels) > 4.0f;
}

size_t count_added(const TexturedMesh& textured, float square_limit) {
    const ImportMesh& mesh = *textured.mesh;
    size_t added = 0;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (size_t c = 0; c < 3; ++c)
            added += is_long(textured, mesh.indices[i + c], mesh.indices[i + (c + 1) % 3], square_limit);
    return added;
}

// The vertex in the middle of each divided edge, by its ends; sorted, so that it can be searched.
using Middles = std::vector<std::pair<std::pair<uint32_t, uint32_t>, uint32_t>>;

std::pair<uint32_t, uint32_t> edge_of(uint32_t a, uint32_t b) { return std::minmax(a, b); }

Middles make_middles(const TexturedMesh& textured, float square_limit) {
    ImportMesh& mesh = *textured.mesh;
    Middles middles;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (size_t c = 0; c < 3; ++c) {
            uint32_t a = mesh.indices[i + c], b = mesh.indices[i + (c + 1) % 3];
            if (is_long(textured, a, b, square_limit)) middles.push_back({edge_of(a, b), 0});
        }
    std::sort(middles.begin(), middles.end());
    middles.erase(std::unique(middles.begin(), middles.end()), middles.end());
    for (auto& [edge, middle] : middles) {
        auto [a, b] = edge;
        middle = uint32_t(mesh.positions_plant.size());
        mesh.positions_plant.push_back((mesh.positions_plant[a] + mesh.positions_plant[b]) * 0.5f);
        mesh.normals_plant.push_back(
            normalize_or(mesh.normals_plant[a] + mesh.normals_plant[b], mesh.normals_plant[a]));
        mesh.colors_linear.push_back((mesh.colors_linear[a] + mesh.colors_linear[b]) * 0.5f);
        mesh.uvs.push_back((mesh.uvs[a] + mesh.uvs[b]) * 0.5f);
    }
    return middles;
}

void divide(const TexturedMesh& textured, float square_limit) {
    ImportMesh& mesh = *textured.mesh;
    Middles middles = make_middles(textured, square_limit);
    if (middles.empty()) return;
    std::vector<uint32_t> indices, elements;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* v = &mesh.indices[t * 3];
        uint32_t middle[3];
        int divided = 0, turn = 0;
        for (int c = 0; c < 3; ++c) {
            auto edge = edge_of(v[c], v[(c + 1) % 3]);
            auto found = std::lower_bound(middles.begin(), middles.end(), std::pair(edge, 0u));
            bool has = found != middles.end() && found->first == edge;
            middle[c] = has ? found->second : UINT32_MAX;
            divided += has;
        }
        auto emit = [&](uint32_t a, uint32_t b, uint32_t c) {
            indices.insert(indices.end(), {a, b, c});
            elements.push_back(mesh.elements[t]);
        };
        // Turned so that edge 0 is divided and, where one is not, it is the last.
        while (divided > 0 && divided < 3 &&
               !(middle[turn] != UINT32_MAX && middle[(turn + 2) % 3] == UINT32_MAX))
            ++turn;
        uint32_t a = v[turn], b = v[(turn + 1) % 3], c = v[(turn + 2) % 3];
        uint32_t ab = middle[turn], bc = middle[(turn + 1) % 3], ca = middle[(turn + 2) % 3];
        if (divided == 0) {
            emit(a, b, c);
        } else if (divided == 1) {
            emit(a, ab, c);
            emit(ab, b, c);
        } else if (divided == 2) {
            emit(ab, b, bc);
            emit(a, ab, bc);
            emit(a, bc, c);
        } else {
            emit(a, ab, ca);
            emit(ab, b, bc);
            emit(ca, bc, c);
            emit(ab, bc, ca);
        }
    }
    mesh.indices = std::move(indices);
    mesh.elements = std::move(elements);
}

}  // namespace

void divide_long_edges(const std::vector<TexturedMesh>& meshes, float edge_m, size_t added_triangle_limit) {
    float longest = 0.0f;
    for (const TexturedMesh& textured : meshes)
        for (size_t i = 0; i + 2 < textured.mesh->indices.size(); i += 3)
            for (size_t c = 0; c < 3; ++c) {
                const uint32_t* v = &textured.mesh->indices[i];
                longest = std::max(longest, square_length(*textured.mesh, v[c], v[(c + 1) % 3]));
            }
    // From the longest edges down, so that what the limit leaves is even.
    for (float limit = std::sqrt(longest) * 0.75f;; limit *= 0.75f) {
        limit = std::max(limit, edge_m);
        size_t added = 0;
        for (const TexturedMesh& mesh : meshes) added += count_added(mesh, limit * limit);
        if (added > added_triangle_limit || (added == 0 && limit <= edge_m)) return;
        added_triangle_limit -= added;
        for (const TexturedMesh& mesh : meshes) divide(mesh, limit * limit);
        if (added > 0) limit /= 0.75f;  // halves may still be too long
    }
}

}  // namespace coppice
