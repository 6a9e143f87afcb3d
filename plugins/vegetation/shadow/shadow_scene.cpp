#include "plugins/vegetation/shadow/shadow_scene.h"

#include <algorithm>

namespace coppice {
namespace {

dvec3 unit_or(dvec3 v, dvec3 otherwise) {
    const double length = std::sqrt(glm::dot(v, v));
    return length > 1e-12 && length < 1e12 ? v / length : otherwise;
}

double within(double value, double least, double most, double otherwise) {
    return std::isfinite(value) ? std::clamp(value, least, most) : otherwise;
}

// A side that is not a number empties the box.
DoubleBox check_box(const Box& box) {
    if (box.empty()) return {dvec3(1.0), dvec3(-1.0)};
    return {glm::clamp(dvec3(box.min), -k_farthest_m, k_farthest_m),
            glm::clamp(dvec3(box.max), -k_farthest_m, k_farthest_m)};
}

}  // namespace

CheckedShadowScene check_shadow_scene(const ShadowScene& scene) {
    CheckedShadowScene checked;
    checked.forward = unit_or(dvec3(scene.forward), dvec3(0.0, 0.0, -1.0));
    const dvec3 other = std::fabs(checked.forward.y) < 0.9 ? dvec3(0.0, 1.0, 0.0) : dvec3(1.0, 0.0, 0.0);
    const dvec3 any_right = unit_or(glm::cross(checked.forward, other), dvec3(1.0, 0.0, 0.0));
    const dvec3 right(scene.right);
    checked.right = unit_or(right - checked.forward * glm::dot(right, checked.forward), any_right);
    checked.up = glm::cross(checked.right, checked.forward);
    checked.tangent_x = within(scene.tangent_x, 1e-6, 1e6, 1.0);
    checked.tangent_y = within(scene.tangent_y, 1e-6, 1e6, 1.0);
    checked.near_m = within(scene.near_m, 1e-6, 0.5 * k_farthest_m, 0.1);
    checked.far_m = within(scene.far_m, checked.near_m * 1.001, k_farthest_m, k_farthest_m);
    checked.receivers = check_box(scene.receivers);
    checked.casters = check_box(scene.casters);
    const dvec3 to_sun = checked.to_sun = unit_or(dvec3(scene.to_sun), dvec3(0.0, 1.0, 0.0));
    // The ground's axes, turned as the zenith is turned into the sun; a sun below one's feet is any other.
    const double turn = 1.0 + to_sun.y;
    const dvec3 halfway = (to_sun + dvec3(0.0, 1.0, 0.0)) * (turn > 1e-9 ? 1.0 / turn : 0.0);
    checked.across = unit_or(dvec3(1.0, 0.0, 0.0) - halfway * to_sun.x, dvec3(1.0, 0.0, 0.0));
    checked.along = glm::cross(checked.across, to_sun);
    checked.side_texels = std::max(double(scene.side_texels), 16.0);
    return checked;
}

}  // namespace coppice
