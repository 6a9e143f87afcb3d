// The part that all kinds of shadow map share: the homography of the light's plane with a given growth of w, fitted to
// the receivers, and the depth.
#pragma once
#include <span>
#include "plugins/vegetation/shadow/shadow_scene.h"

namespace coppice {

// w at one place of the receivers is at most so many times w at another: what more would gain in the foreground is lost
// behind it, and float rows stay well conditioned.
inline constexpr double k_most_w_ratio = 256.0;

// A place's coordinates in the light's plane, m.
inline glm::dvec2 on_light_plane(const CheckedShadowScene& scene, dvec3 p) {
    return glm::dvec2(glm::dot(scene.across, p), glm::dot(scene.along, p));
}

// w = 1 + dot(growth_per_m, place - middle) with the middle of the hull's bounds in the light's plane, by less where
// k_most_w_ratio would be passed, and of that a share in [0, 1]; 0 is the uniform map. hull: a ReceiverHull's.
ShadowView fit_plane_map(const CheckedShadowScene& scene, std::span<const dvec3> hull,
                         glm::dvec2 growth_per_m, double share);

// The middle that growth_per_m refers to.
glm::dvec2 middle_of(const CheckedShadowScene& scene, std::span<const dvec3> hull);

}  // namespace coppice
