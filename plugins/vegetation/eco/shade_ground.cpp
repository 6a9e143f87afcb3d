#include "plugins/vegetation/eco/shade_ground.h"

#include <algorithm>
#include <cassert>

namespace coppice {

void shade_ground(const Scene& scene, Terrain& terrain, std::span<const Box> model_bounds_plant) {
    assert(model_bounds_plant.size() >= scene.models.size());
    vec3 sun = normalize_or(scene.light.direction_to_sun, vec3(0, 1, 0));
    float horizontal = std::sqrt(sun.x * sun.x + sun.z * sun.z);
    vec3 away = normalize_or(vec3(-sun.x, 0.0f, -sun.z), vec3(0.0f));
    float per_height = sun.y > 0.0f ? std::min(horizontal / std::max(sun.y, 0.05f), 3.0f) : 0.0f;
    dvec3 terrain_origin = terrain.origin_world();
    for (const SceneTile& tile : scene.tiles) {
        vec3 origin(tile.tile.origin_world - terrain_origin);
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const Box& bounds = model_bounds_plant[scene.plant_models[row].model];
            const PlantPosition& p = scene.positions[row];
            float height_m = bounds.empty() ? 0.0f : bounds.max.y * p.scale;
            if (!(height_m > 0.5f)) continue;
            // Crowns are ragged: four fifths of the box's half width hold most of the leaves.
            float radius_m = 0.2f * (bounds.size().x + bounds.size().z) * p.scale;
            float amount = 0.55f * std::min(height_m / 6.0f, 1.0f);
            // Where the crown's middle casts its shadow, but never off its own foot.
            float shift_m = std::min(0.5f * height_m * per_height, 0.6f * radius_m);
            terrain.shade(origin.x + p.x_tile + away.x * shift_m, origin.z + p.z_tile + away.z * shift_m,
                          radius_m * 1.25f, amount);
        }
    }
}

}  // namespace coppice
