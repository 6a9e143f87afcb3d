// Perspective shadow maps (Stamminger and Drettakis 2002): the sun, a point or a direction in the viewer's space after projection, looks
// at what the viewer sees there. All their cases are one here: with the sun's homogeneous place l = (l.xyz, l.w), which lies at infinity
// in the world, the map's rows in projected space q are l.w (e . q.xyz) - (e . l.xyz) q.w for three axes e, and those are at right
// angles to the sun whatever the sign of l.w.
#include "plugins/vegetation/shadow/light_plane.h"

namespace coppice {
namespace {

// The infinitely far lies at least at this depth of projected space, in which receivers end at 1: the nearer, the more of the map is
// spent on what is near.
constexpr double k_least_infinity = 1.02;
// Of a receiver over another's: w beyond this would leave hardly a texel to the farther.
constexpr double k_most_w_ratio = 50.0;
constexpr int k_rounds = 40;

struct Projection {
    dvec4 x, y, z, w;  // rows
};

// Of a camera slid back by back_m, whose angles of view are refitted around the receivers.
Projection virtual_camera(const ShadowScene& scene, const ReceiverHull& hull, double back_m) {
    const dvec3 right(scene.right), up(scene.up), forward(scene.forward);
    double tangent_x = 1e-9, tangent_y = 1e-9, near_m = INFINITY, far_m = 0.0;
    for (const dvec3& p : hull.places()) {
        const double distance = glm::dot(forward, p) + back_m;
        tangent_x = std::max(tangent_x, std::fabs(glm::dot(right, p)) / distance);
        tangent_y = std::max(tangent_y, std::fabs(glm::dot(up, p)) / distance);
        near_m = std::min(near_m, distance);
        far_m = std::max(far_m, distance);
    }
    far_m = std::max(far_m, near_m * (1.0 + 1e-6));
    const double infinity = far_m / (far_m - near_m);
    return {dvec4(right / tangent_x, 0.0), dvec4(up / tangent_y, 0.0),
            dvec4(forward * infinity, (back_m - near_m) * infinity), dvec4(forward, back_m)};
}

LightPlaneRows rows_of(const ShadowScene& scene, const ReceiverHull& hull, double back_m) {
    const Projection camera = virtual_camera(scene, hull, back_m);
    const dvec3 to_sun(scene.to_sun);
    const dvec3 sun(glm::dot(dvec3(camera.x), to_sun), glm::dot(dvec3(camera.y), to_sun),
                    glm::dot(dvec3(camera.z), to_sun));
    const double sun_w = glm::dot(dvec3(camera.w), to_sun);
    auto row = [&](dvec3 e) {
        return (camera.x * e.x + camera.y * e.y + camera.z * e.z) * sun_w - camera.w * glm::dot(e, sun);
    };
    // From the sun to the middle of what is seen.
    const dvec3 ahead = dvec3(0.0, 0.0, 0.5) * sun_w - sun;
    const double length = glm::length(ahead);
    if (!(length > 0.0)) return uniform_rows(view_axes(scene));
    const dvec3 axis = ahead / length;
    // The map's rows go away from the viewer; where it looks along the sun's rays, upwards.
    const dvec3 away = std::fabs(axis.z) < 0.9999 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
    const dvec3 across = glm::normalize(glm::cross(away, axis));
    return {row(across), row(glm::cross(axis, across)), row(axis)};
}

// Of w, over the receivers; infinite where one lies behind the sun's picture plane.
double w_ratio(const LightPlaneRows& rows, const ReceiverHull& hull) {
    double least = INFINITY, most = 0.0;
    for (const dvec3& p : hull.places()) {
        const double w = at_place(rows.w, p);
        least = std::min(least, w);
        most = std::max(most, w);
    }
    return least > 0.0 ? most / least : INFINITY;
}

}  // namespace

LightPlaneRows perspective_rows(const ShadowScene& scene, const ReceiverHull& hull) {
    const double near_m = double(scene.near_m), far_m = double(scene.far_m);
    auto suits = [&](double back_m) {
        return w_ratio(rows_of(scene, hull, back_m), hull) <= k_most_w_ratio;
    };
    // Slid back until infinity is so far, and until the sun sees all receivers before it: as little as that takes.
    double least_m = std::max(k_least_infinity * (far_m - near_m) - far_m, 0.0);
    if (suits(least_m)) return rows_of(scene, hull, least_m);
    double enough_m = std::max(least_m, near_m);
    for (int i = 0; i < k_rounds && !suits(enough_m); ++i) enough_m *= 2.0;
    if (!suits(enough_m)) return uniform_rows(view_axes(scene));
    for (int i = 0; i < k_rounds; ++i) {
        const double middle_m = 0.5 * (least_m + enough_m);
        (suits(middle_m) ? enough_m : least_m) = middle_m;
    }
    return rows_of(scene, hull, enough_m);
}

}  // namespace coppice
