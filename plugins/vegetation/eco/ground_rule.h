// What a plant asks of the ground under it, and how it stands there.
#pragma once
#include "runtime/core/math.h"

namespace coppice {

struct GroundRule {
    float align_to_ground = 0.0f;  // [0, 1]: 1 stands at right angles to the slope
    float slope_most_rad = k_pi;
    float altitude_low_m = -INFINITY, altitude_high_m = INFINITY;  // of the ground, world y

    // Least y of the ground's normal; not above zero: every slope will do.
    float least_up() const { return slope_most_rad < k_pi * 0.5f ? portable_cos(slope_most_rad) : -1.0f; }
    bool takes_height(double y) const { return y >= double(altitude_low_m) && y <= double(altitude_high_m); }
    // Where an upright plant's tip goes on ground with this normal, moved by `lean` (a unit vector near y).
    vec3 tip(vec3 lean, vec3 normal) const {
        return normalize_or(lean + vec3(normal.x, normal.y - 1.0f, normal.z) * align_to_ground,
                            vec3(0, 1, 0));
    }
    bool operator==(const GroundRule&) const = default;
};

}  // namespace coppice
