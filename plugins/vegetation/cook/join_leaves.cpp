#include "plugins/vegetation/cook/join_leaves.h"

#include <algorithm>

namespace coppice {
namespace {

// Choices of four of eight in their three cyclic orders, each with both diagonals; ascending, so that ties have an order.
constexpr size_t k_quad_count = 70 * 6;
constexpr std::array<std::array<uint8_t, 4>, k_quad_count> k_quads = [] {
    std::array<std::array<uint8_t, 4>, k_quad_count> quads{};
    size_t count = 0;
    for (uint8_t a = 0; a < 8; ++a)
        for (uint8_t b = uint8_t(a + 1); b < 8; ++b)
            for (uint8_t c = uint8_t(b + 1); c < 8; ++c)
                for (uint8_t d = uint8_t(c + 1); d < 8; ++d)
                    for (auto [p, q, r] : {std::array{b, c, d}, std::array{b, d, c}, std::array{c, b, d}}) {
                        quads[count++] = {a, p, q, r};
                        quads[count++] = {p, q, r, a};
                    }
    return quads;
}();

struct Weights {
    float area = 1.0f, middle = 1.0f, turn = 1.0f;
};

}  // namespace

JoinedLeaf join_leaves(const MeasuredLeaf& a, const MeasuredLeaf& b, const std::array<vec3, 4>& raw_a,
                       const std::array<vec3, 4>& raw_b) {
    std::array<vec3, 8> place;
    const double total = a.area_m2 + b.area_m2;
    const float share = total > 0.0 ? float(a.area_m2 / total) : 0.5f;
    const vec3 middle = a.middle * share + b.middle * (1.0f - share);
    for (size_t k = 0; k < 4; ++k) place[k] = raw_a[k] - middle, place[k + 4] = raw_b[k] - middle;
    const vec3 other = glm::dot(a.facing, b.facing) < 0.0f ? -b.facing : b.facing;
    const vec3 facing = normalize_or(a.facing * share + other * (1.0f - share), a.facing);
    const float size_m = std::max(std::sqrt(float(total)), 1e-20f);

    JoinedLeaf best{{0, 1, 2, 3}, 1.0f};
    float best_score = INFINITY, best_area_m2 = 0.0f;
    const Weights weights;
    for (const auto& quad : k_quads) {
        const vec3 p0 = place[quad[0]], p1 = place[quad[1]], p2 = place[quad[2]], p3 = place[quad[3]];
        const vec3 diagonal = p2 - p0, n0 = glm::cross(p1 - p0, diagonal), n1 = glm::cross(diagonal, p3 - p0);
        const float area = 0.5f * (std::sqrt(glm::dot(n0, n0)) + std::sqrt(glm::dot(n1, n1)));
        if (!(area > 0.0f) || !(glm::dot(n0, n1) >= 0.0f)) continue;
        const float ratio = area / float(total);
        const vec3 center = (p0 + p1 + p2 + p3) * 0.25f;
        const float turned = 1.0f - 0.5f * std::fabs(glm::dot(n0 + n1, facing)) / area;
        const float score = weights.area * std::fabs(portable_log2(ratio)) +
                            weights.middle * std::sqrt(glm::dot(center, center)) / size_m +
                            weights.turn * turned;
        if (score < best_score) best_score = score, best.corners = quad, best_area_m2 = area;
    }
    if (best_area_m2 > 0.0f) best.growth = std::sqrt(float(total / double(best_area_m2)));
    return best;
}

}  // namespace coppice
