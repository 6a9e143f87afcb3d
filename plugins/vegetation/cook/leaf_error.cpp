#include "plugins/vegetation/cook/leaf_error.h"

#include <algorithm>

namespace coppice {
namespace {

float square(vec3 v) { return glm::dot(v, v); }

float segment_distance_square(vec3 p, vec3 a, vec3 b) {
    const vec3 along = b - a, to = p - a;
    const float length_square = square(along);
    const float t = length_square > 0.0f ? std::clamp(glm::dot(to, along) / length_square, 0.0f, 1.0f) : 0.0f;
    return square(to - along * t);
}

float triangle_distance_square(vec3 p, vec3 a, vec3 b, vec3 c) {
    const vec3 n = glm::cross(b - a, c - a);
    const float n_square = square(n);
    if (n_square > 0.0f && glm::dot(glm::cross(b - a, p - a), n) >= 0.0f &&
        glm::dot(glm::cross(c - b, p - b), n) >= 0.0f && glm::dot(glm::cross(a - c, p - c), n) >= 0.0f) {
        const float height = glm::dot(p - a, n);
        return height * height / n_square;
    }
    return std::min({segment_distance_square(p, a, b), segment_distance_square(p, b, c),
                     segment_distance_square(p, c, a)});
}

// The largest of `farthest_square` and the squared distances of the corners to the surface; stops at enough_square.
float corner_distance_square(const Leaf& corners, const Leaf& surface, float farthest_square,
                             float enough_square) {
    const auto& s = surface.corners_plant;
    for (vec3 p : corners.corners_plant) {
        if (farthest_square >= enough_square) break;
        const float near = triangle_distance_square(p, s[0], s[1], s[2]);
        if (near <= farthest_square) continue;
        farthest_square =
            std::max(farthest_square, std::min(near, triangle_distance_square(p, s[0], s[2], s[3])));
    }
    return farthest_square;
}

float largest_of(vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

}  // namespace

MeasuredLeaf measure_leaf(const Leaf& leaf) {
    MeasuredLeaf measured{leaf, leaf_area_m2(leaf), {}, vec3(0), vec3(0), {}};
    for (vec3 corner : leaf.corners_plant) {
        measured.middle += corner * 0.25f;
        measured.box.include(corner);
    }
    const auto& p = leaf.corners_plant;
    for (vec3 n : {glm::cross(p[1] - p[0], p[2] - p[0]) * 0.5f, glm::cross(p[2] - p[0], p[3] - p[0]) * 0.5f})
        add_spread(measured.spread, n, std::sqrt(glm::dot(n, n)));
    measured.facing = normalize_or(glm::cross(p[2] - p[0], p[3] - p[1]), leaf.normal_plant);
    return measured;
}

float leaf_error_m(const MeasuredLeaf& a, const MeasuredLeaf& b, const LeafErrorWeights& weights,
                   float enough) {
    const float turn_m = weights.turn * std::sqrt(float(a.area_m2 + b.area_m2)) *
                         std::max(1.0f - std::fabs(glm::dot(a.facing, b.facing)), 0.0f);
    const vec3 apart = b.middle - a.middle;
    const float plane_m =
        weights.plane * 0.5f * (std::fabs(glm::dot(apart, a.facing)) + std::fabs(glm::dot(apart, b.facing)));
    const float planarity_m = turn_m + plane_m;
    // What reaches farther to one side is at least that far away.
    const float reach_m = std::max(largest_of(a.box.min - b.box.min), largest_of(a.box.max - b.box.max));
    if (planarity_m + reach_m >= enough) return planarity_m + reach_m;
    const float left_m = enough - planarity_m, left_square = left_m * left_m;
    float farthest_square = corner_distance_square(a.leaf, b.leaf, 0.0f, left_square);
    farthest_square = corner_distance_square(b.leaf, a.leaf, farthest_square, left_square);
    return planarity_m + std::sqrt(farthest_square);
}

}  // namespace coppice
