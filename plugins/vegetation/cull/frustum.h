// What the camera can see, as planes. All coordinates are camera-relative: the viewer is the origin, the axes are the
// world's.
#pragma once
#include <array>
#include <cmath>
#include "plugins/vegetation/components.h"

namespace coppice {

struct Frustum {
    static constexpr uint32_t k_picture_planes = 5, k_most_planes = 13;
    vec3 right, up, forward;  // the camera's axes, unit
    // (n, o): dot(n, p) + o >= 0 inside; n unit. Of a picture near, left, right, bottom, top, the last four through the origin;
    // of what throws shadows into it those of cull/caster_frustum.h.
    std::array<vec4, k_most_planes> planes;
    uint32_t plane_count;
    float near_m;
    float focal_px;    // image height / (2 tan(fov / 2))
    float corner_cos;  // of the angle between the axis and the image's corners
};

Frustum make_frustum(const Camera& camera, uint32_t width_px, uint32_t height_px);

// Conservative: false only where nothing of the sphere can be seen.
inline bool sees_sphere(const Frustum& frustum, vec3 center, float radius) {
    for (uint32_t i = 0; i < frustum.plane_count; ++i)
        if (glm::dot(vec3(frustum.planes[i]), center) + frustum.planes[i].w < -radius) return false;
    return true;
}

// A flat image shows a solid angle as cos^-3 of its angle to the axis times its area at the axis: the square root of
// that, so that lengths scale by it. 1 to corner_cos^(-3/2), also for what lies outside the image.
inline float off_axis_stretch(float corner_cos, float along_m, float distance_m) {
    const float cosine = along_m > corner_cos * distance_m ? along_m / distance_m : corner_cos;
    return distance_m > 0.0f ? 1.0f / (cosine * std::sqrt(cosine)) : 1.0f;
}
inline float off_axis_stretch(const Frustum& frustum, vec3 center, float distance_m) {
    return off_axis_stretch(frustum.corner_cos, glm::dot(frustum.forward, center), distance_m);
}

// Of all that the box holds at most, at nearest_m and beyond: off the axis more is asked for than at the box's centre.
inline float most_pixels_per_meter(const Frustum& frustum, const Box& box, float nearest_m) {
    const vec3 center = box.center();
    float most = off_axis_stretch(frustum, center, glm::length(center)) / std::max(nearest_m, frustum.near_m);
    for (uint32_t i = 0; i < 8; ++i) {
        const vec3 corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                          i & 4 ? box.max.z : box.min.z);
        const float distance_m = glm::length(corner);
        most = std::max(most,
                        off_axis_stretch(frustum, corner, distance_m) / std::max(distance_m, frustum.near_m));
    }
    return frustum.focal_px * most;
}

enum class Visibility { outside, across, inside };
Visibility see_box(const Frustum& frustum, const Box& box);

}  // namespace coppice
