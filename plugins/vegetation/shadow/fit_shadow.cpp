#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

ShadowView fit_shadow(ShadowKind, const ShadowScene& scene) {
    const vec3 across = perpendicular_to(scene.to_sun), along = glm::cross(scene.to_sun, across);
    Box seen;
    for (int i = 0; i < 8; ++i) {
        const float distance = i & 1 ? scene.near_m : scene.far_m;
        const vec3 p = (scene.forward + scene.right * (i & 2 ? scene.tangent_x : -scene.tangent_x) +
                        scene.up * (i & 4 ? scene.tangent_y : -scene.tangent_y)) *
                       distance;
        seen.include(glm::clamp(p, scene.receivers.min, scene.receivers.max));
    }
    vec3 low(INFINITY), high(-INFINITY);
    auto include = [&](const Box& box, bool only_depth) {
        for (int i = 0; i < 8; ++i) {
            const vec3 p(i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y, i & 4 ? box.min.z : box.max.z);
            const vec3 at(glm::dot(p, across), glm::dot(p, along), glm::dot(p, scene.to_sun));
            if (only_depth) {
                low.z = std::min(low.z, at.z);
                high.z = std::max(high.z, at.z);
            } else {
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
        }
    };
    include(seen, false);
    include(scene.casters, true);
    const float border = 2.0f, side = float(scene.side_texels);
    const vec3 size = glm::max(high - low, vec3(1e-3f));
    const vec2 scale = (side - 2.0f * border) / vec2(size.x, size.y);
    ShadowView view;
    view.row_x = vec4(across * scale.x, border - low.x * scale.x);
    view.row_y = vec4(along * scale.y, border - low.y * scale.y);
    view.row_z = vec4(scene.to_sun / size.z, -low.z / size.z);
    return view;
}

}  // namespace coppice
