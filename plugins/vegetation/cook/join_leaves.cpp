#include "plugins/vegetation/cook/join_leaves.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr size_t k_triangle_count = 56, k_quad_count = 70 * 6;

using TriangleCorners = std::array<uint8_t, 3>;

struct Quad {
    std::array<uint8_t, 4> corners;
    std::array<uint8_t, 2> triangles;  // (0, 1, 2) and (0, 2, 3), of k_triangles
    int8_t sense;                      // -1 where they turn differently as k_triangles lists them
};

constexpr std::array<TriangleCorners, k_triangle_count> k_triangles = [] {
    std::array<TriangleCorners, k_triangle_count> triangles{};
    size_t count = 0;
    for (uint8_t a = 0; a < 8; ++a)
        for (uint8_t b = uint8_t(a + 1); b < 8; ++b)
            for (uint8_t c = uint8_t(b + 1); c < 8; ++c) triangles[count++] = {a, b, c};
    return triangles;
}();

// Choices of four of eight in their three cyclic orders, each with both diagonals.
constexpr std::array<Quad, k_quad_count> k_quads = [] {
    std::array<uint8_t, 256> triangle_of_set{};
    for (uint8_t t = 0; t < k_triangle_count; ++t)
        triangle_of_set[1u << k_triangles[t][0] | 1u << k_triangles[t][1] | 1u << k_triangles[t][2]] = t;
    int sense = 1;
    auto triangle = [&](uint8_t a, uint8_t b, uint8_t c) {
        // Each exchange that would sort them turns the triangle round.
        if ((int(a > b) + int(a > c) + int(b > c)) % 2 == 1) sense = -sense;
        return triangle_of_set[1u << a | 1u << b | 1u << c];
    };
    std::array<Quad, k_quad_count> quads{};
    size_t count = 0;
    auto add = [&](std::array<uint8_t, 4> c) {
        sense = 1;
        const uint8_t first = triangle(c[0], c[1], c[2]), second = triangle(c[0], c[2], c[3]);
        quads[count++] = {c, {first, second}, int8_t(sense)};
    };
    for (uint8_t a = 0; a < 8; ++a)
        for (uint8_t b = uint8_t(a + 1); b < 8; ++b)
            for (uint8_t c = uint8_t(b + 1); c < 8; ++c)
                for (uint8_t d = uint8_t(c + 1); d < 8; ++d)
                    for (auto [p, q, r] : {std::array{b, c, d}, std::array{b, d, c}, std::array{c, b, d}}) {
                        add({a, p, q, r});
                        add({p, q, r, a});
                    }
    return quads;
}();

struct Triangle {
    vec3 area_vector;
    float area_m2;
    NormalSpread spread;
};

// What a quad is off by is counted in these units: the area it should have, the side of a square of that area, and, for how it
// faces and how flat it is, all of it.
constexpr float k_spread_weight = 2.0f, k_flatness_weight = 4.0f;
constexpr float k_sharpest_fold =
    -0.9f;  // cosine between the triangles' normals: at -1 they lie on each other

}  // namespace

JoinedLeaf join_leaves(const MeasuredLeaf& a, const MeasuredLeaf& b, const std::array<vec3, 4>& raw_a,
                       const std::array<vec3, 4>& raw_b, const JoinWish& wish) {
    const double total_m2 = a.area_m2 + b.area_m2;
    JoinedLeaf best{{0, 1, 2, 3}, 1.0f};
    if (!(total_m2 > 0.0)) return best;
    const float total = float(total_m2), wished_m2 = total * wish.area, share = float(a.area_m2 / total_m2);
    const vec3 middle = a.middle * share + b.middle * (1.0f - share);
    std::array<vec3, 8> place;
    for (size_t k = 0; k < 4; ++k) place[k] = raw_a[k] - middle, place[k + 4] = raw_b[k] - middle;
    std::array<Triangle, k_triangle_count> triangles;
    for (size_t t = 0; t < k_triangle_count; ++t) {
        const vec3 p = place[k_triangles[t][0]], q = place[k_triangles[t][1]], r = place[k_triangles[t][2]];
        const vec3 n = glm::cross(q - p, r - p) * 0.5f;
        triangles[t] = {n, std::sqrt(glm::dot(n, n)), {}};
        add_spread(triangles[t].spread, n, triangles[t].area_m2);
    }
    NormalSpread wanted;
    for (size_t k = 0; k < 6; ++k) wanted[k] = (a.spread[k] + b.spread[k]) / total + wish.lean[k];

    float best_score = INFINITY, best_area_m2 = 0.0f;
    const float per_size = 0.25f / std::sqrt(total);
    for (const Quad& quad : k_quads) {
        const Triangle& s = triangles[quad.triangles[0]];
        const Triangle& t = triangles[quad.triangles[1]];
        const float area_m2 = s.area_m2 + t.area_m2;
        const float fold = glm::dot(s.area_vector, t.area_vector) * float(quad.sense);
        if (!(area_m2 > 0.0f) || !(fold >= k_sharpest_fold * s.area_m2 * t.area_m2)) continue;
        const float ratio = area_m2 / wished_m2;
        float score = std::max(ratio, 1.0f / ratio) - 1.0f;
        if (score >= best_score) continue;
        const vec3 center =
            place[quad.corners[0]] + place[quad.corners[1]] + place[quad.corners[2]] + place[quad.corners[3]];
        const vec3 facing = s.area_vector + t.area_vector * float(quad.sense);
        const float per_area = 1.0f / area_m2;
        float off_square = 0.0f;
        for (size_t k = 0; k < 6; ++k) {
            const float off = (s.spread[k] + t.spread[k]) * per_area - wanted[k];
            off_square += off * off * (k < 3 ? 1.0f : 2.0f);
        }
        score +=
            std::sqrt(glm::dot(center, center)) * per_size + k_spread_weight * std::sqrt(off_square) +
            k_flatness_weight * std::fabs(std::sqrt(glm::dot(facing, facing)) * per_area - wish.flatness);
        if (score < best_score) best_score = score, best.corners = quad.corners, best_area_m2 = area_m2;
    }
    if (best_area_m2 > 0.0f) best.growth = std::sqrt(wished_m2 / best_area_m2);
    return best;
}

}  // namespace coppice
