#include "plugins/vegetation/eco/plant_features.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace coppice {
namespace {

constexpr float k_least_height_m = 1e-3f;
constexpr double k_share_below_crown = 0.05;
constexpr size_t k_height_steps = 512;

// Half of a closed surface faces the viewer; that stems are closed is near enough between plants of one kind.
constexpr double k_seen_of_stems = 0.5;

struct Surface {
    Box bounds;
    dvec3 along{0.0};  // m2, seen along each axis
    double area_m2 = 0.0;
    dvec3 color_area{0.0};
    std::array<double, k_height_steps> area_at_height{};
};

// body(corner, corner, corner, area vector in m2) for each triangle with finite corners.
template <class Body>
void for_each_triangle(const PartDescription& part, Body&& body) {
    for (size_t t = 0; t + 2 < part.indices.size(); t += 3) {
        const DescriptionVertex& a = part.vertices[part.indices[t]];
        const DescriptionVertex& b = part.vertices[part.indices[t + 1]];
        const DescriptionVertex& c = part.vertices[part.indices[t + 2]];
        if (!is_finite(a.position_plant) || !is_finite(b.position_plant) || !is_finite(c.position_plant))
            continue;
        const dvec3 origin(a.position_plant);
        body(a, b, c, 0.5 * glm::cross(dvec3(b.position_plant) - origin, dvec3(c.position_plant) - origin));
    }
}

Box bounds_of(const PlantDescription& plant) {
    Box bounds;
    for (const PartDescription& part : plant.parts)
        for_each_triangle(part, [&](const auto& a, const auto& b, const auto& c, dvec3) {
            for (const DescriptionVertex* corner : {&a, &b, &c}) bounds.include(corner->position_plant);
        });
    return bounds;
}

void add_part(Surface& surface, const PartDescription& part, float height_m) {
    for_each_triangle(part, [&](const auto& a, const auto& b, const auto& c, dvec3 area) {
        const double area_m2 = glm::length(area);
        for (const DescriptionVertex* corner : {&a, &b, &c}) surface.bounds.include(corner->position_plant);
        surface.along += glm::abs(area);
        surface.area_m2 += area_m2;
        const dvec3 color =
            (dvec3(a.color_linear) + dvec3(b.color_linear) + dvec3(c.color_linear)) * (1.0 / 3.0);
        if (std::isfinite(color.x + color.y + color.z)) surface.color_area += color * area_m2;
        const float middle_m = (a.position_plant.y + b.position_plant.y + c.position_plant.y) / 3.0f;
        const float step = std::clamp(middle_m / height_m, 0.0f, 1.0f) * float(k_height_steps);
        surface.area_at_height[std::min(size_t(step), k_height_steps - 1)] += area_m2;
    });
}

float crown_base_m(const Surface& crown, float height_m) {
    double below_m2 = 0.0;
    size_t step = 0;
    while (step + 1 < k_height_steps &&
           below_m2 + crown.area_at_height[step] < k_share_below_crown * crown.area_m2)
        below_m2 += crown.area_at_height[step++];
    return height_m * float(step) / float(k_height_steps);
}

}  // namespace

PlantFeatures measure_features(const PlantDescription& plant) {
    const Box bounds = bounds_of(plant);
    const float height_m = bounds.empty() ? k_least_height_m : std::max(bounds.max.y, k_least_height_m);
    Surface leaves, stems;
    for (const PartDescription& part : plant.parts) add_part(part.leaf ? leaves : stems, part, height_m);
    const Surface& crown = leaves.area_m2 > 0.0 ? leaves : stems;
    const vec3 width = crown.bounds.empty() ? vec3(0.0f) : crown.bounds.size();
    const dvec3 along = leaves.along + stems.along * k_seen_of_stems;
    const dvec3 color = leaves.area_m2 > 0.0 ? leaves.color_area / leaves.area_m2 : dvec3(0.0);
    return {height_m,       crown_base_m(crown, height_m),
            width.x,        width.z,
            float(along.x), float(along.y),
            float(along.z), float(leaves.area_m2),
            float(color.x), float(color.y),
            float(color.z)};
}

}  // namespace coppice
