#include "plugins/vegetation/plant/leaf.h"

#include <algorithm>
#include <vector>
#include <fmt/format.h>

namespace coppice {
namespace {

double triangle_area_m2(vec3 a, vec3 b, vec3 c) {
    const dvec3 n = glm::cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a));
    return 0.5 * std::sqrt(glm::dot(n, n));
}

}  // namespace

double leaf_area_m2(const Leaf& leaf) {
    const auto& p = leaf.corners_plant;
    return triangle_area_m2(p[0], p[1], p[2]) + triangle_area_m2(p[0], p[2], p[3]);
}

Leaf collapsed_leaf(std::span<const Leaf> crown, const LeafCollapse& collapse) {
    Leaf leaf{{}, collapse.normal_plant, collapse.color_linear};
    vec3 middle(0);
    for (size_t k = 0; k < 4; ++k) {
        leaf.corners_plant[k] = crown[collapse.corners[k] / 4].corners_plant[collapse.corners[k] % 4];
        middle += leaf.corners_plant[k] * 0.25f;
    }
    for (vec3& corner : leaf.corners_plant) corner = middle + (corner - middle) * collapse.growth;
    return leaf;
}

Status check_collapses(uint32_t leaf_count, std::span<const LeafCollapse> collapses,
                       const std::string& file) {
    if (collapses.size() > std::max(leaf_count, 1u) - 1)
        return fail(ErrorId::file_corrupt, file, "leaf collapses",
                    fmt::format("{} of {} leaves", collapses.size(), leaf_count), "cook the plant again");
    std::vector<bool> gone(leaf_count + collapses.size(), false);
    for (size_t i = 0; i < collapses.size(); ++i) {
        const LeafCollapse& c = collapses[i];
        const auto [first, second] = c.removed;
        bool sound = first < second && second < leaf_count + i && !gone[first] && !gone[second];
        for (uint32_t corner : c.corners) sound = sound && corner / 4 < leaf_count;
        sound = sound && c.growth > 0.0f && std::isfinite(c.growth) && c.error_m >= 0.0f &&
                is_finite(c.normal_plant) && is_finite(c.color_linear);
        if (!sound)
            return fail(
                ErrorId::file_corrupt, file, fmt::format("leaf collapses[{}]", i),
                fmt::format("joins leaves {} and {}", first, second),
                "two leaves that are there, corners of the crown and finite numbers: cook the plant again");
        gone[first] = gone[second] = true;
    }
    return {};
}

}  // namespace coppice
