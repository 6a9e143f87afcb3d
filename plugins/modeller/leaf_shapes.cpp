#include "plugins/modeller/leaf_shapes.h"

#include <algorithm>
#include <span>

namespace coppice::modeller {
namespace {

// The right half of a leaf: points (x, y) and triangles between them. Points on the midrib have x = 0 and are
// shared with the mirrored left half. Triangles turn counter-clockwise seen from the upper side.
struct HalfOutline {
    std::span<const vec2> points;
    std::span<const std::array<uint8_t, 3>> triangles;
};

constexpr vec2 k_rhombic_points[] = {{0, 0}, {0.5f, 0.42f}, {0, 1}};
constexpr std::array<uint8_t, 3> k_rhombic_triangles[] = {{0, 1, 2}};

constexpr vec2 k_ovate_points[] = {{0, 0}, {0.5f, 0.27f}, {0.40f, 0.62f}, {0, 1}};
constexpr vec2 k_lanceolate_points[] = {{0, 0}, {0.5f, 0.36f}, {0.36f, 0.70f}, {0, 1}};
constexpr std::array<uint8_t, 3> k_ovate_triangles[] = {{0, 1, 2}, {0, 2, 3}};

// Birch: a triangle with a long tip on a broad wedge.
constexpr vec2 k_birch_points[] = {{0, 0}, {0.5f, 0.28f}, {0.22f, 0.66f}, {0, 1}};

// Oak: two lobes a side, widest beyond the middle.
constexpr vec2 k_oak_points[] = {{0, 0}, {0.36f, 0.30f}, {0.19f, 0.45f}, {0.5f, 0.74f}, {0, 1}};
constexpr std::array<uint8_t, 3> k_oak_triangles[] = {{0, 1, 2}, {0, 2, 4}, {2, 3, 4}};

constexpr vec2 k_heart_points[] = {{0, 0},         {0.22f, -0.13f}, {0.46f, 0.03f}, {0.5f, 0.26f},
                                   {0.30f, 0.64f}, {0, 1},          {0, 0.5f}};
constexpr std::array<uint8_t, 3> k_heart_triangles[] = {
    {0, 1, 2}, {0, 2, 3}, {0, 3, 6}, {6, 3, 4}, {6, 4, 5}};

constexpr vec2 k_spoon_points[] = {{0, 0}, {0.10f, 0.30f}, {0.5f, 0.70f}, {0.32f, 0.93f}, {0, 1}, {0, 0.5f}};
constexpr std::array<uint8_t, 3> k_spoon_triangles[] = {{0, 1, 5}, {5, 1, 2}, {5, 2, 3}, {5, 3, 4}};

constexpr vec2 k_petal_points[] = {{0, 0}, {0.22f, 0.0f}, {0.5f, 0.55f}, {0.27f, 0.95f}, {0, 1}, {0, 0.5f}};
constexpr std::array<uint8_t, 3> k_petal_triangles[] = {{0, 1, 5}, {5, 1, 2}, {5, 2, 3}, {5, 3, 4}};

HalfOutline outline_of(LeafShape shape) {
    switch (shape) {
        case LeafShape::rhombic:
            return {k_rhombic_points, k_rhombic_triangles};
        case LeafShape::ovate:
            return {k_ovate_points, k_ovate_triangles};
        case LeafShape::lanceolate:
            return {k_lanceolate_points, k_ovate_triangles};
        case LeafShape::birch:
            return {k_birch_points, k_ovate_triangles};
        case LeafShape::oak:
            return {k_oak_points, k_oak_triangles};
        case LeafShape::heart:
            return {k_heart_points, k_heart_triangles};
        case LeafShape::spoon:
            return {k_spoon_points, k_spoon_triangles};
        case LeafShape::petal:
            return {k_petal_points, k_petal_triangles};
        case LeafShape::needles:
            break;
    }
    return {};
}

// The midrib becomes an arc of length 1; z and y follow it.
vec3 bend_along_arc(vec3 p, float curve_rad) {
    if (std::fabs(curve_rad) < 1e-4f) return p;
    float radius = 1.0f / curve_rad;
    float angle = p.y * curve_rad;
    float s = portable_sin(angle), c = portable_cos(angle);
    return {p.x, (radius + p.z) * s, (radius + p.z) * c - radius};
}

}  // namespace

LeafMesh make_leaf_mesh(LeafShape shape, float width_ratio, float fold_rad, float curve_rad) {
    HalfOutline half = outline_of(shape);
    LeafMesh mesh;
    std::vector<uint32_t> mirrored(half.points.size());
    float fold_cos = portable_cos(fold_rad), fold_sin = portable_sin(fold_rad);
    auto add = [&](vec2 p) {
        vec3 folded(p.x * width_ratio * fold_cos, p.y, std::fabs(p.x) * width_ratio * fold_sin);
        mesh.positions.push_back(bend_along_arc(folded, curve_rad));
        mesh.along.push_back(std::clamp(p.y, 0.0f, 1.0f));
        mesh.edge.push_back(std::min(2.0f * std::fabs(p.x), 1.0f));
        return uint32_t(mesh.positions.size() - 1);
    };
    for (vec2 p : half.points) add(p);
    for (size_t i = 0; i < half.points.size(); ++i) {
        vec2 p = half.points[i];
        mirrored[i] = p.x == 0.0f ? uint32_t(i) : add({-p.x, p.y});
    }
    for (const auto& t : half.triangles) {
        mesh.triangles.push_back({t[0], t[1], t[2]});
        mesh.triangles.push_back({mirrored[t[0]], mirrored[t[2]], mirrored[t[1]]});
    }
    mesh.normals.assign(mesh.positions.size(), vec3(0));
    for (const auto& t : mesh.triangles) {
        vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        vec3 area = glm::cross(b - a, c - a);
        for (uint32_t corner : t) mesh.normals[corner] += area;
    }
    for (vec3& n : mesh.normals) n = normalize_or(n, vec3(0, 0, 1));
    return mesh;
}

uint32_t triangles_of_leaf(LeafShape shape, uint32_t needles) {
    return shape == LeafShape::needles ? needles : 2 * uint32_t(outline_of(shape).triangles.size());
}

}  // namespace coppice::modeller
