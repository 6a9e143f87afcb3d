// Views with the sun at a given angle to them, and maps taken apart in double.
#pragma once
#include <gtest/gtest.h>
#include <vector>
#include "plugins/vegetation/shadow/shadow_view.h"
#include "runtime/core/random.h"

namespace coppice {

inline constexpr ShadowKind k_shadow_kinds[] = {ShadowKind::uniform, ShadowKind::perspective,
                                                ShadowKind::light_space};

inline const char* name_of(ShadowKind kind) {
    return kind == ShadowKind::uniform       ? "uniform"
           : kind == ShadowKind::perspective ? "perspective"
                                             : "light space";
}

// As a host's camera turns: yaw, pitch, then roll.
inline void turn_camera(ShadowScene& scene, double yaw_rad, double pitch_rad, double roll_rad) {
    const dvec3 forward(-std::sin(yaw_rad) * std::cos(pitch_rad), std::sin(pitch_rad),
                        -std::cos(yaw_rad) * std::cos(pitch_rad));
    const dvec3 level(std::cos(yaw_rad), 0.0, -std::sin(yaw_rad));
    const dvec3 up = glm::cross(level, forward);
    scene.forward = vec3(forward);
    scene.right = vec3(level * std::cos(roll_rad) + up * std::sin(roll_rad));
    scene.up = vec3(up * std::cos(roll_rad) - level * std::sin(roll_rad));
}

// Its light at this angle to the view, towards the camera's own up side, or beside it by turn_rad.
inline void set_sun(ShadowScene& scene, double angle_rad, double turn_rad) {
    const dvec3 side = dvec3(scene.up) * std::cos(turn_rad) + dvec3(scene.right) * std::sin(turn_rad);
    scene.to_sun = vec3(dvec3(scene.forward) * std::cos(angle_rad) + side * std::sin(angle_rad));
}

// A wood around a viewer of 1.7 m.
inline ShadowScene made_wood() {
    ShadowScene scene{};
    scene.tangent_x = 0.77f;
    scene.tangent_y = 0.5774f;
    scene.near_m = 0.3f;
    scene.far_m = 300.0f;
    scene.receivers = {vec3(-200.0f, -1.7f, -200.0f), vec3(200.0f, 28.3f, 200.0f)};
    scene.casters = scene.receivers;
    scene.to_sun = vec3(0.0f, 0.6f, 0.8f);
    scene.side_texels = 1024;
    turn_camera(scene, 0.0, 0.0, 0.0);
    return scene;
}

// Places inside the frustum and the box; may be fewer than asked for. Near and far ones alike.
inline std::vector<vec3> receivers_of(const ShadowScene& scene, uint32_t count, Random& random) {
    std::vector<vec3> places;
    for (uint32_t i = 0; i < 64 * count && places.size() < count; ++i) {
        const float z = scene.near_m * std::pow(scene.far_m / scene.near_m, random.next_in(0.0f, 1.0f));
        const vec3 p = (scene.forward + scene.right * (scene.tangent_x * random.next_in(-1.0f, 1.0f)) +
                        scene.up * (scene.tangent_y * random.next_in(-1.0f, 1.0f))) *
                       z;
        const Box& b = scene.receivers;
        if (p.x >= b.min.x && p.y >= b.min.y && p.z >= b.min.z && p.x <= b.max.x && p.y <= b.max.y &&
            p.z <= b.max.z)
            places.push_back(p);
    }
    return places;
}

struct MapPlace {
    double column, row, depth, w;
};
inline MapPlace place_on(const ShadowView& view, dvec3 p) {
    auto dot = [&](vec4 row) {
        return double(row.x) * p.x + double(row.y) * p.y + double(row.z) * p.z + double(row.w);
    };
    const double w = dot(view.row_w);
    return {dot(view.row_x) / w, dot(view.row_y) / w, dot(view.row_z) / w, w};
}
inline bool all_finite(const ShadowView& view) {
    for (vec4 row : {view.row_x, view.row_y, view.row_z, view.row_w})
        for (int i = 0; i < 4; ++i)
            if (!std::isfinite(row[i])) return false;
    return std::isfinite(view.least_w) && view.least_w > 0.0f;
}

// Texels a metre of a plane that faces the sun, in the map's worst direction, at p.
inline double texels_per_meter(const ShadowView& view, vec3 to_sun, vec3 p) {
    const dvec3 sun = glm::normalize(dvec3(to_sun));
    const dvec3 s = glm::normalize(glm::cross(sun, std::fabs(sun.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
    const dvec3 t = glm::cross(sun, s);
    const double step = 1e-4 * (1.0 + glm::length(dvec3(p)));
    const MapPlace here = place_on(view, p), a = place_on(view, dvec3(p) + s * step),
                   b = place_on(view, dvec3(p) + t * step);
    const double ax = (a.column - here.column) / step, ay = (a.row - here.row) / step;
    const double bx = (b.column - here.column) / step, by = (b.row - here.row) / step;
    const double squares = ax * ax + ay * ay + bx * bx + by * by, area = std::fabs(ax * by - ay * bx);
    // The lesser singular value.
    const double larger =
        std::sqrt(0.5 * (squares + std::sqrt(std::max(squares * squares - 4.0 * area * area, 0.0))));
    return larger > 0.0 ? area / larger : 0.0;
}

}  // namespace coppice
