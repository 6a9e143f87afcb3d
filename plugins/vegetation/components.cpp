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
vec3 Camera::right() const { return vec3(portable_cos(yaw_rad), 0.0f, -portable_sin(yaw_rad)); }
vec3 Camera::up() const { return glm::cross(right(), forward()); }

}  // namespace coppice
