#include "plugins/vegetation/cull/caster_frustum.h"

namespace coppice {

Frustum make_caster_frustum(const Frustum& view, vec3 to_sun, float far_m) {
    Frustum casters = view;
    casters.plane_count = 0;
    auto add = [&](vec3 normal, float offset_m) {
        casters.planes[casters.plane_count++] = vec4(normal, offset_m);
    };
    // Around the axis: left, bottom, right, top; corner i lies between side i and side i + 1.
    const vec3 sides[4] = {vec3(view.planes[1]), vec3(view.planes[3]), vec3(view.planes[2]),
                           vec3(view.planes[4])};
    bool stays[4];
    vec3 corners[4];
    for (int i = 0; i < 4; ++i) {
        stays[i] = glm::dot(sides[i], to_sun) >= 0.0f;
        if (stays[i]) add(sides[i], 0.0f);
        const vec3 ray = glm::cross(sides[i], sides[(i + 1) % 4]);
        const float along = glm::dot(ray, view.forward);
        corners[i] = ray * (far_m / along);
    }
    const bool far_stays = glm::dot(-view.forward, to_sun) >= 0.0f;
    if (far_stays) add(-view.forward, far_m);

    const vec3 middle = view.forward * (0.5f * far_m);
    auto add_silhouette = [&](vec3 along, vec3 through) {
        // Where the sun lies along the edge the plane would be of rounding errors, and its faces bound nearly as well.
        const vec3 across = glm::cross(along, to_sun);
        if (glm::dot(across, across) < 1e-8f * glm::dot(along, along)) return;
        const vec3 normal = glm::normalize(across);
        const float offset_m = -glm::dot(normal, through);
        const bool turned = glm::dot(normal, middle) + offset_m < 0.0f;
        add(turned ? -normal : normal, turned ? -offset_m : offset_m);
    };
    for (int i = 0; i < 4; ++i) {
        const int next = (i + 1) % 4;
        if (stays[i] != stays[next]) add_silhouette(corners[i], vec3(0.0f));
        if (stays[next] != far_stays) add_silhouette(corners[next] - corners[i], corners[i]);
    }
    return casters;
}

}  // namespace coppice
