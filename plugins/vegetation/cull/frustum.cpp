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
        return vec4(normalize_or(axis + forward * tangent, forward), 0.0f);
    };
    frustum.plane_count = Frustum::k_picture_planes;
    frustum.planes[0] = vec4(frustum.forward, -frustum.near_m);
    frustum.planes[1] = side(frustum.right, frustum.forward, tangent_x);
    frustum.planes[2] = side(-frustum.right, frustum.forward, tangent_x);
    frustum.planes[3] = side(frustum.up, frustum.forward, tangent_y);
    frustum.planes[4] = side(-frustum.up, frustum.forward, tangent_y);
    return frustum;
}

Visibility see_box(const Frustum& frustum, const Box& box) {
    vec3 center = box.center(), half = box.size() * 0.5f;
    bool inside = true;
    for (uint32_t i = 0; i < frustum.plane_count; ++i) {
        const vec3 normal = vec3(frustum.planes[i]);
        const float distance = glm::dot(normal, center) + frustum.planes[i].w;
        const float reach =
            std::fabs(normal.x) * half.x + std::fabs(normal.y) * half.y + std::fabs(normal.z) * half.z;
        if (distance < -reach) return Visibility::outside;
        inside = inside && distance >= reach;
    }
    return inside ? Visibility::inside : Visibility::across;
}

}  // namespace coppice
