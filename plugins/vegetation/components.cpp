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

mat3 rotation_matrix(PlantTurn turn) {
    constexpr float k_step = 1.0f / 32767.0f;
    float x = float(turn.x) * k_step, y = float(turn.y) * k_step;
    float z = float(turn.z) * k_step, w = float(turn.w) * k_step;
    return mat3(vec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
                vec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
                vec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)));
}

vec3 Camera::forward() const {
    float c = portable_cos(pitch_rad);
    return vec3(-portable_sin(yaw_rad) * c, portable_sin(pitch_rad), -portable_cos(yaw_rad) * c);
}
vec3 Camera::right() const { return vec3(portable_cos(yaw_rad), 0.0f, -portable_sin(yaw_rad)); }
vec3 Camera::up() const { return glm::cross(right(), forward()); }

}  // namespace coppice
