#include "plugins/vegetation/shadow/shadow_view.h"
#include <vector>
#include <cstdlib>

namespace coppice {

ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene) {
    std::vector<vec3> places;
    const int n = 24, m = 60;
    for (int k = 0; k <= m; ++k) {
        const float distance = scene.near_m * std::pow(scene.far_m / scene.near_m, float(k) / m);
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n; ++j) {
                const vec3 p = (scene.forward + scene.right * (scene.tangent_x * (2.0f * i / n - 1.0f)) +
                                scene.up * (scene.tangent_y * (2.0f * j / n - 1.0f))) * distance;
                const vec3 q = glm::clamp(p, scene.receivers.min, scene.receivers.max);
                if (glm::length(q - p) < 0.05f * distance) places.push_back(q);
            }
    }
    if (places.empty()) places.push_back(vec3(0.0f));
    const vec3 up = scene.to_sun;
    vec3 along = scene.forward - up * glm::dot(scene.forward, up);
    const float sine = glm::length(along);
    along = normalize_or(along, perpendicular_to(up));
    const vec3 across = glm::cross(up, along);
    vec3 low(INFINITY), high(-INFINITY);
    for (const vec3& p : places) {
        const vec3 at(glm::dot(p, across), glm::dot(p, along), glm::dot(p, up));
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    for (int i = 0; i < 8; ++i) {
        const vec3 p(i & 1 ? scene.casters.min.x : scene.casters.max.x, i & 2 ? scene.casters.min.y : scene.casters.max.y, i & 4 ? scene.casters.min.z : scene.casters.max.z);
        high.z = std::max(high.z, glm::dot(p, up));
    }
    const float border = 2.0f, side = float(scene.side_texels), inner = side - 2.0f * border;
    ShadowView view;
    // w = n + (y - low.y) along; x' = x / w; y' = (y - low.y) ( ... ) / w
    const float d = high.y - low.y;
    float nn = 1e30f;
    if (kind != ShadowKind::uniform) {
        const char* e = getenv("LN");
        const float zn = e ? atof(e) : scene.near_m;
        (void)sine;
        nn = zn + std::sqrt(zn * (d + zn));
        if (getenv("LM")) nn = d * atof(getenv("LM"));
    }
    // y' = f (y0) / (n + y0) * ... in [0,1]: y' = (n + d) / d * y0 / (n + y0)
    auto map = [&](vec4& row_w) {
        if (nn > 1e20f) { row_w = vec4(0, 0, 0, 1); return; }
        row_w = vec4(along / nn, (nn - low.y) / nn);
    };
    map(view.row_w);
    view.least_w = nn > 1e20f ? 0.5f : 1e-3f;
    auto w_of = [&](vec3 p) { return glm::dot(vec3(view.row_w), p) + view.row_w.w; };
    float x_low = INFINITY, x_high = -INFINITY, z_low = INFINITY, z_high = -INFINITY;
    for (const vec3& p : places) {
        const float x = glm::dot(p, across) / w_of(p);
        x_low = std::min(x_low, x);
        x_high = std::max(x_high, x);
    }
    (void)z_low; (void)z_high;
    const float sx = inner / (x_high - x_low);
    view.row_x = vec4(across * sx, 0.0f) + view.row_w * (border - x_low * sx);
    if (nn > 1e20f) {
        view.row_y = vec4(along * (inner / d), border - low.y * inner / d);
        view.row_z = vec4(up / (high.z - low.z), -low.z / (high.z - low.z));
    } else {
        const float k = (nn + d) / (d * nn) * inner;  // y0 / (w nn) ...
        view.row_y = vec4(along * k, -low.y * k) + view.row_w * border;
        // depth: (z - low.z) / (range) but divided by w: scaled so that the largest is 1: z w / w
        const float most_w = (nn + d) / nn;
        // depth = 0.5 + 0.5 * z/(w * range) is not monotone in z alone across w, only per ray: fine
        float zl = INFINITY, zh = -INFINITY;
        for (const vec3& p : places) { float z = (glm::dot(p, up)) / w_of(p); zl = std::min(zl, z); zh = std::max(zh, (high.z) / w_of(p)); }
        (void)most_w;
        view.row_z = vec4(up / (zh - zl), 0.0f) + view.row_w * (-zl / (zh - zl));
    }
    return view;
}

}  // namespace coppice
