#include "tools/reference/light.h"

#include <algorithm>

namespace coppice {
namespace {

vec3 blend(vec3 a, vec3 b, float share_of_b) { return a * (1.0f - share_of_b) + b * share_of_b; }

float power(float base, int doublings) {
    for (int i = 0; i < doublings; ++i) base *= base;
    return base;
}

}  // namespace

Light with_unit_sun(Light light) {
    light.direction_to_sun = normalize_or(light.direction_to_sun, vec3(0.0f));
    return light;
}

Shade shade(const Light& light, const Surface& surface, vec3 to_viewer) {
    const bool turned = surface.leaf && glm::dot(surface.normal, to_viewer) < 0.0f;
    const vec3 normal = turned ? -surface.normal : surface.normal;
    const float facing = glm::dot(normal, light.direction_to_sun);
    vec3 sent = surface.color_linear * std::max(facing, 0.0f);
    if (surface.leaf) {
        // Young green: what leaves let through is yellower and more saturated than what they throw back.
        const vec3 passed_color = glm::min(surface.color_linear * vec3(1.25f, 1.35f, 0.55f), vec3(1.0f));
        sent += passed_color * (0.8f * std::max(-facing, 0.0f));
    }
    const vec3 mean_sky = blend(light.sky_horizon_color, light.sky_zenith_color, 0.5f);
    const vec3 around = blend(light.ground_color, mean_sky, 0.5f + 0.5f * normal.y);
    return {light.sun_color * sent, surface.color_linear * around * surface.openness};
}

float stand_in_sun(float openness) { return 0.12f + (1.0f - 0.12f) * openness * openness; }

vec3 sky_radiance(const Light& light, vec3 direction) {
    const float up = std::clamp(direction.y, 0.0f, 1.0f);
    const vec3 sky = blend(light.sky_horizon_color, light.sky_zenith_color, std::sqrt(up));
    const float toward = std::max(glm::dot(direction, light.direction_to_sun), 0.0f);
    // A wide glow, the 8th power of the cosine, and the disc's surroundings, the 512th.
    return sky + light.sun_color * (0.06f * power(toward, 3) + 0.25f * power(toward, 9));
}

float clear_share(const Light& light, float distance_m) {
    return portable_exp(-light.haze_density_per_m * distance_m);
}

vec3 apply_haze(const Light& light, vec3 radiance, float distance_m) {
    return blend(light.haze_color, radiance, clear_share(light, distance_m));
}

}  // namespace coppice
