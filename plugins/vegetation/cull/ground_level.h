// Which level of a terrain's patch is drawn. What draws the ground and what culls by it must agree.
#pragma once
#include <algorithm>
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/cull/frustum.h"

namespace coppice {

// The coarsest whose error stays under error_px on the picture, 0: the finest. Requires at least one level.
inline uint32_t choose_ground_level(const TerrainPatch& patch, std::span<const TerrainLevel> levels,
                                    const Box& bounds_camera, const Frustum& frustum, float error_px) {
    const float distance_m =
        std::max(glm::length(glm::clamp(vec3(0.0f), bounds_camera.min, bounds_camera.max)), frustum.near_m);
    uint32_t level = patch.level_count - 1;
    while (level > 0 && levels[patch.first_level + level].error_m * frustum.focal_px > error_px * distance_m)
        --level;
    return level;
}

}  // namespace coppice
