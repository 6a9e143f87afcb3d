#include "plugins/vegetation/cull/frustum.h"

#include <algorithm>

namespace coppice {

Frustum make_frustum(const Camera& camera, uint32_t width_px, uint32_t height_px) {
    Frustum frustum;
    frustum.right = camera.right();
    frustum.forward = camera.forward();
    frustum.up = camera.up();
    frustum.near_m = camera.near_m;
    float half = std::clamp(camera.vertical_fov_rad, 0.001f, 3.1f) * 0.5f;
    float tangent_y = portable_sin(half) / portable_cos(half);
    float tangent_x = tangent_y * float(std::max(width_px, 1u)) / float(std::max(height_px, 1u));
    frustum.focal_px = float(std::max(height_px, 1u)) / (2.0f * tangent_y);
    frustum.corner_cos = 1.0f / std::sqrt(1.0f + tangent_x * tangent_x + tangent_y * tangent_y);
    auto side = [](vec3 axis, vec3 forward, float tangent) {
        return normalize_or(axis + forward * tangent, forward);  // dot(n, x axis_part + forward) >= 0 inside
    };
    frustum.side_normals[0] = side(frustum.right, frustum.forward, tangent_x);
    frustum.side_normals[1] = side(-frustum.right, frustum.forward, tangent_x);
    frustum.side_normals[2] = side(frustum.up, frustum.forward, tangent_y);
    frustum.side_normals[3] = side(-frustum.up, frustum.forward, tangent_y);
    return frustum;
}

Visibility see_box(const Frustum& frustum, const Box& box) {
    vec3 center = box.center(), half = box.size() * 0.5f;
    bool inside = true;
    auto outside_of = [&](vec3 normal, float offset) {
        float distance = glm::dot(normal, center) - offset;
        float reach =
            std::fabs(normal.x) * half.x + std::fabs(normal.y) * half.y + std::fabs(normal.z) * half.z;
        inside = inside && distance >= reach;
        return distance < -reach;
    };
    if (outside_of(frustum.forward, frustum.near_m)) return Visibility::outside;
    for (const vec3& normal : frustum.side_normals)
        if (outside_of(normal, 0.0f)) return Visibility::outside;
    return inside ? Visibility::inside : Visibility::across;
}

}  // namespace coppice
