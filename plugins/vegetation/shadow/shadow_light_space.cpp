// Light-space perspective maps (Wimmer, Scherzer and Purgathofer 2004; ERRATA 6): w grows along the view as the light's
// plane shows it, from n at the nearest receiver to n + d at the farthest, d their extent there. The paper's n goes to
// infinity, which is the uniform map, as the angle between light and view goes to zero; the band of angles below makes
// sure that it has got there while the view's direction in the plane turns fastest.
#include <algorithm>
#include "plugins/vegetation/shadow/fit_plane_map.h"
#include "plugins/vegetation/shadow/receiver_hull.h"
#include "plugins/vegetation/shadow/view_angle.h"

namespace coppice {
namespace {

constexpr double k_whole_sine = 0.2;

}  // namespace

ShadowView fit_shadow_light_space(const ShadowScene& scene) {
    const CheckedShadowScene checked = check_shadow_scene(scene);
    const ReceiverHull hull(checked);
    const glm::dvec2 view = on_light_plane(checked, checked.forward);
    const double sine = std::sqrt(glm::dot(view, view));  // of the angle between light and view
    const double share = warped_share(sine, k_whole_sine);
    if (share <= 0.0) return fit_plane_map(checked, hull, glm::dvec2(0.0), 0.0);
    const glm::dvec2 direction = view / sine;
    double nearest_m = INFINITY, first_m = INFINITY, last_m = -INFINITY;
    for (const dvec3& corner : hull) {
        nearest_m = std::min(nearest_m, glm::dot(checked.forward, corner));
        const double at_m = glm::dot(direction, on_light_plane(checked, corner));
        first_m = std::min(first_m, at_m);
        last_m = std::max(last_m, at_m);
    }
    const double d = last_m - first_m;
    const double near_m = std::max(nearest_m, checked.near_m) / sine;  // z_n'
    const double far_m = near_m + d * sine;                            // z_f'
    const double n = (near_m + std::sqrt(far_m * near_m)) / sine;
    const double middle_m = glm::dot(direction, middle_of(checked, hull));
    return fit_plane_map(checked, hull, direction / (n + middle_m - first_m), share);
}

}  // namespace coppice
