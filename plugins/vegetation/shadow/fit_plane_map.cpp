#include "plugins/vegetation/shadow/fit_plane_map.h"

#include <algorithm>

namespace coppice {
namespace {

using glm::dvec2;
using glm::dvec4;

struct Bounds {
    dvec2 min{INFINITY}, max{-INFINITY};
    void include(dvec2 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    dvec2 size() const { return max - min; }
    dvec2 middle() const { return (min + max) * 0.5; }
};

constexpr double k_least_side_m = 1e-4;  // of receivers, where their sides are compared

// A linear function of places, as a row: dot(row, (p, 1)).
dvec4 row_of(dvec3 axis, double offset) { return dvec4(axis, offset); }

}  // namespace

dvec2 middle_of(const CheckedShadowScene& scene, std::span<const dvec3> hull) {
    Bounds bounds;
    for (const dvec3& corner : hull) bounds.include(on_light_plane(scene, corner));
    return bounds.middle();
}

ShadowView fit_plane_map(const CheckedShadowScene& scene, std::span<const dvec3> hull, dvec2 growth,
                         double share) {
    const dvec2 middle = middle_of(scene, hull);
    if (!(std::isfinite(growth.x) && std::isfinite(growth.y))) growth = dvec2(0.0);
    double least = 0.0, most = 0.0;
    for (const dvec3& corner : hull) {
        const double growing = glm::dot(growth, on_light_plane(scene, corner) - middle);
        least = std::min(least, growing);
        most = std::max(most, growing);
    }
    // (1 + r most) / (1 + r least) is the ratio at r times the growth.
    const double bound = most - k_most_w_ratio * least;
    const double eased = share * (bound > k_most_w_ratio - 1.0 ? (k_most_w_ratio - 1.0) / bound : 1.0);
    growth *= eased;
    const double contrast = (most - least) * eased;

    // A map with this w, and no turn and scale 1 at the middle: (place - middle) / w. A strong growth makes it long in
    // the growth's direction; it is pressed until both sides are alike. With no growth there is no direction: the
    // pressing fades with the square of the contrast, so that nothing jumps when the growth turns round through zero.
    const double length = std::sqrt(glm::dot(growth, growth));
    const dvec2 direction = length > 0.0 ? growth / length : dvec2(1.0, 0.0);
    Bounds aligned;
    for (const dvec3& corner : hull) {
        const dvec2 at = on_light_plane(scene, corner) - middle;
        const dvec2 warped = at / (1.0 + glm::dot(growth, at));
        aligned.include(dvec2(glm::dot(direction, warped), direction.x * warped.y - direction.y * warped.x));
    }
    const double pressed = std::clamp(
        (aligned.size().y + k_least_side_m) / (aligned.size().x + k_least_side_m), 1.0 / 64.0, 64.0);
    const double press = (pressed - 1.0) * contrast * contrast / (contrast * contrast + 0.25);

    // Columns and rows as functions of places, times w.
    const dvec3 along_growth = scene.across * direction.x + scene.along * direction.y;
    const double middle_along = glm::dot(middle, direction);
    const dvec4 across = row_of(scene.across + along_growth * (press * direction.x),
                                -middle.x - press * direction.x * middle_along);
    const dvec4 along = row_of(scene.along + along_growth * (press * direction.y),
                               -middle.y - press * direction.y * middle_along);
    const dvec4 w = row_of(scene.across * growth.x + scene.along * growth.y, 1.0 - glm::dot(growth, middle));
    Bounds box;
    double least_w = INFINITY, lowest_m = INFINITY, highest_m = -INFINITY, reach_m = 0.0;
    for (const dvec3& corner : hull) {
        const dvec4 p(corner, 1.0);
        const double w_here = std::max(glm::dot(w, p), 1e-6);
        box.include(dvec2(glm::dot(across, p), glm::dot(along, p)) / w_here);
        least_w = std::min(least_w, w_here);
        lowest_m = std::min(lowest_m, glm::dot(scene.to_sun, corner));
        highest_m = std::max(highest_m, glm::dot(scene.to_sun, corner));
        reach_m = std::max(reach_m, std::sqrt(glm::dot(corner, corner)));
    }
    least_w *= 0.5;
    if (!scene.casters.empty())
        for (uint32_t i = 0; i < 8; ++i) {
            const DoubleBox& b = scene.casters;
            const dvec3 corner(i & 1 ? b.max.x : b.min.x, i & 2 ? b.max.y : b.min.y,
                               i & 4 ? b.max.z : b.min.z);
            highest_m = std::max(highest_m, glm::dot(scene.to_sun, corner));
        }

    // A receiver that is a point or a line still gets a map with an inside.
    const dvec2 size = glm::max(box.size(), dvec2(1e-5 * (reach_m + 0.01)));
    const dvec2 scale = (scene.side_texels - 2.0 * (double(k_shadow_border_texels) + 0.01)) / size;
    const dvec2 offset = dvec2(0.5 * scene.side_texels) - box.middle() * scale;
    const double margin_m = 1e-3 * (highest_m - lowest_m) + 1e-6 * (reach_m + 1.0);
    const double depth_per_m = least_w / (highest_m - lowest_m + 2.0 * margin_m);

    ShadowView view;
    view.row_x = vec4(across * scale.x + w * offset.x);
    view.row_y = vec4(along * scale.y + w * offset.y);
    view.row_z = vec4(row_of(scene.to_sun, margin_m - lowest_m) * depth_per_m);
    view.row_w = vec4(w);
    view.least_w = float(least_w);
    return view;
}

}  // namespace coppice
