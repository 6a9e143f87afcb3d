#include "editor/view/ground_pick.h"

#include "plugins/vegetation/eco/ground_height.h"

namespace coppice {
namespace {

constexpr double k_farthest_pick_m = 4000.0;

float half_height(const Camera& camera) {
    return portable_sin(0.5f * camera.vertical_fov_rad) / portable_cos(0.5f * camera.vertical_fov_rad);
}

}  // namespace

vec3 ray_through(const Camera& camera, ViewSize size, vec2 cursor_px) {
    const float up = half_height(camera) * (1.0f - 2.0f * cursor_px.y / size.height_px);
    const float right = half_height(camera) * (2.0f * cursor_px.x - size.width_px) / size.height_px;
    return glm::normalize(camera.forward() + camera.right() * right + camera.up() * up);
}

std::optional<dvec3> pick_ground(const Camera& camera, ViewSize size, vec2 cursor_px,
                                 const Terrain* terrain) {
    const dvec3 from = camera.position_world, ray = dvec3(ray_through(camera, size, cursor_px));
    auto above_m = [&](double t) {
        const dvec3 at = from + ray * t;
        return at.y - ground_height(terrain, at.x, at.z);
    };
    if (above_m(0.0) <= 0.0) return {};
    // Steps no longer than would pass over a slope of 1:1 unseen, but growing with the distance.
    double before = 0.0;
    for (double t = 0.0; t < k_farthest_pick_m;) {
        t += std::max({0.25, 0.5 * above_m(t), 0.004 * t});
        if (above_m(t) > 0.0) {
            before = t;
            continue;
        }
        double behind = t;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (before + behind);
            (above_m(middle) > 0.0 ? before : behind) = middle;
        }
        dvec3 place = from + ray * behind;
        place.y = ground_height(terrain, place.x, place.z);
        return place;
    }
    return {};
}

std::optional<vec2> project(const Camera& camera, ViewSize size, dvec3 place_world) {
    const vec3 p = vec3(place_world - camera.position_world);
    const float away = glm::dot(p, camera.forward());
    if (!(away > camera.near_m)) return {};
    const float scale = 0.5f * size.height_px / (half_height(camera) * away);
    return vec2(0.5f * size.width_px + glm::dot(p, camera.right()) * scale,
                0.5f * size.height_px - glm::dot(p, camera.up()) * scale);
}

}  // namespace coppice
