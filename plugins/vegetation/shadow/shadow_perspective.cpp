// The map of Stamminger and Drettakis 2002: the sun, moved by the viewer's projection, looks at the receivers moved
// likewise. Source: the paper, 4; ERRATA 6. Deviates: its three cases (the sun beside, before and behind the viewer: at
// infinity, a point, a point that takes light in) are one formula here, without a threshold. Let (X, Y, Z, W)(p) be the
// projection of a place and L, L_w that of the direction to the sun. What the moved sun sees at p is in the direction
//     D(p) = L_w (X, Y, Z)(p) - L W(p),
// whichever sign L_w has, and for L_w = 0 as well; and looked at along the unit vector d towards the middle of the
// moved receivers, w = dot(d, D(p)). D is zero for the sun itself, so that w is a function of the light's plane.
#include <algorithm>
#include "plugins/vegetation/shadow/fit_plane_map.h"
#include "plugins/vegetation/shadow/receiver_hull.h"
#include "plugins/vegetation/shadow/view_angle.h"

namespace coppice {
namespace {

// Infinity's depth in the space moved to. 1 is the viewer's own projection, whose sun may stand among the receivers.
constexpr double k_least_infinity = 1.05;
constexpr double k_whole_sine = 0.5;

}  // namespace

ShadowView fit_shadow_perspective(const ShadowScene& scene) {
    const CheckedShadowScene checked = check_shadow_scene(scene);
    const ReceiverHull hull(checked);
    double near_m = INFINITY, far_m = 0.0;
    for (const dvec3& corner : hull) {
        near_m = std::min(near_m, glm::dot(checked.forward, corner));
        far_m = std::max(far_m, glm::dot(checked.forward, corner));
    }
    near_m = std::max(near_m, checked.near_m);
    const double depth_m = std::max(far_m - near_m, 1e-3 * near_m);
    // Slid back until z_inf = z_f / (z_f - z_n) is large enough, and the field of view fitted again.
    const double back_m = std::max(k_least_infinity * depth_m - (near_m + depth_m), 0.0);
    const double infinity = (near_m + depth_m + back_m) / depth_m;
    double tangent_x = 1e-9, tangent_y = 1e-9;
    for (const dvec3& corner : hull) {
        const double w = std::max(glm::dot(checked.forward, corner), near_m) + back_m;
        tangent_x = std::max(tangent_x, std::fabs(glm::dot(checked.right, corner)) / w);
        tangent_y = std::max(tangent_y, std::fabs(glm::dot(checked.up, corner)) / w);
    }
    const dvec3 axis_x = checked.right / tangent_x, axis_y = checked.up / tangent_y;
    const dvec3 axis_z = checked.forward * infinity;
    const double offset_z = -infinity * near_m;
    dvec3 least(INFINITY), most(-INFINITY);
    for (const dvec3& corner : hull) {
        const double w = std::max(glm::dot(checked.forward, corner), near_m) + back_m;
        const dvec3 moved(glm::dot(axis_x, corner) / w, glm::dot(axis_y, corner) / w,
                          (glm::dot(axis_z, corner) + offset_z) / w);
        least = glm::min(least, moved);
        most = glm::max(most, moved);
    }
    const dvec3 sun(glm::dot(axis_x, checked.to_sun), glm::dot(axis_y, checked.to_sun),
                    glm::dot(axis_z, checked.to_sun));
    const double sun_w = glm::dot(checked.forward, checked.to_sun);
    const dvec3 looking = sun_w * (least + most) * 0.5 - sun;
    // dot(looking, D(p)) as a linear function of p, to be divided by its value in the middle.
    const dvec3 slope = sun_w * (axis_x * looking.x + axis_y * looking.y + axis_z * looking.z) -
                        checked.forward * glm::dot(looking, sun);
    const double start = sun_w * offset_z * looking.z - back_m * glm::dot(looking, sun);
    const glm::dvec2 growth = on_light_plane(checked, slope), middle = middle_of(checked, hull);
    const double w_middle = start + glm::dot(growth, middle);
    // Where the middle lies behind the moved sun, the direction is right and the strength any: fit_plane_map bounds it.
    const double least_w = std::sqrt(glm::dot(growth, growth)) * 1e-6 + 1e-300;
    const glm::dvec2 view = on_light_plane(checked, checked.forward);
    const double share = warped_share(std::sqrt(glm::dot(view, view)), k_whole_sine);
    return fit_plane_map(checked, hull, growth / std::max(w_middle, least_w), share);
}

}  // namespace coppice
