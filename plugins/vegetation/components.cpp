#include "plugins/vegetation/components.h"

#include <algorithm>

namespace coppice {

PlantTurn pack_turn(float x, float y, float z, float w) {
    float length = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(length > 0.0f) || !std::isfinite(length)) return {0, 0, 0, 32767};
    auto pack = [length](float v) {
        return int16_t(std::floor(std::clamp(v / length, -1.0f, 1.0f) * 32767.0f + 0.5f));
    };
    return {pack(x), pack(y), pack(z), pack(w)};
}

vec3 Camera::forward() const {
    float c = portable_cos(pitch_rad);
    return vec3(-portable_sin(yaw_rad) * c, portable_sin(pitch_rad), -portable_cos(yaw_rad) * c);
}
vec3 Camera::right() const {
    const vec3 level(portable_cos(yaw_rad), 0.0f, -portable_sin(yaw_rad));
    if (roll_rad == 0.0f) return level;
    return level * portable_cos(roll_rad) + glm::cross(level, forward()) * portable_sin(roll_rad);
}
vec3 Camera::up() const { return glm::cross(right(), forward()); }

Camera camera_along(dvec3 position_world, vec3 forward, vec3 up, float vertical_fov_rad, float near_m) {
    forward = normalize_or(forward, vec3(0.0f, 0.0f, -1.0f));
    up = normalize_or(up, vec3(0.0f, 1.0f, 0.0f));
    Camera camera;
    camera.position_world = position_world;
    camera.vertical_fov_rad = vertical_fov_rad;
    camera.near_m = near_m;
    camera.pitch_rad = std::asin(std::clamp(forward.y, -1.0f, 1.0f));
    const float level = forward.x * forward.x + forward.z * forward.z;
    // Straight up or down the view has no heading: `up` has.
    const vec3 heading = level > 1e-12f ? forward : up * (forward.y > 0.0f ? -1.0f : 1.0f);
    camera.yaw_rad = std::atan2(-heading.x, -heading.z);
    const vec3 right = camera.right();
    camera.roll_rad = std::atan2(-glm::dot(right, up), glm::dot(glm::cross(right, forward), up));
    return camera;
}

}  // namespace coppice
