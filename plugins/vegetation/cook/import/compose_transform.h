// Translation, rotation and scale as one matrix, the way glTF orders them: T * R * S.
#pragma once
#include "runtime/core/math.h"

namespace coppice {

// q: x, y, z, w, of any length but 0, which gives no rotation.
inline mat4 compose_transform(vec3 translation, vec4 q, vec3 scale) {
    float square = glm::dot(q, q);
    float s = square > 0.0f ? 2.0f / square : 0.0f;
    float x = q.x, y = q.y, z = q.z, w = q.w;
    mat4 m(1.0f);
    m[0] = vec4(1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0) * scale.x;
    m[1] = vec4(s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w), 0) * scale.y;
    m[2] = vec4(s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y), 0) * scale.z;
    m[3] = vec4(translation, 1);
    return m;
}

}  // namespace coppice
