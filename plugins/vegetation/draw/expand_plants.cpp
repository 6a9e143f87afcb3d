#include "plugins/vegetation/draw/expand_plants.h"

#include <algorithm>
#include <utility>
#include "plugins/vegetation/cull/ground_level.h"
#include "plugins/vegetation/eco/part_chance.h"

namespace coppice {
namespace {

// Multiples of the golden section.
float turn_of(uint32_t rest_index) { return float(uint32_t(rest_index * 2654435769u) >> 8) * 0x1p-24f; }

}  // namespace

void draw_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                 uint32_t rest_index, WorkPart& work) {
    const float turn = turn_of(rest_index);
    const SeenPlant* with_instance = nullptr;
    uint32_t instance = 0;
    each_part(seen, geometry, settings,
              [&](const SeenPlant& plant, uint32_t part, const PartProjection& projected) {
                  float chance = part_chance(plant.model, part - plant.first_part_of_model) + turn;
                  if (chance >= 1.0f) chance -= 1.0f;
                  const PartChoice choice = choose_part(geometry.parts[part], projected, settings, chance);
                  if ((choice.triangles | choice.points | choice.lines) == 0) return;
                  if (std::exchange(with_instance, &plant) != &plant)
                      instance = work.add_instance(plant.instance);
                  work.add(geometry.part_geometry[part], choice, instance, turn);
              });
}

ExpandCounts expand_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                           const FrameSettings& settings, uint32_t rest_index, WorkPart& work) {
    SeenPlants seen;
    see_plants(run, geometry, frustum, settings, nullptr, 0.0f, seen);
    draw_plants(seen, geometry, settings, rest_index, work);
    return {uint32_t(seen.plants.size()), seen.full_triangles};
}

namespace {

struct CloudView {
    PlantView view;  // of the tile's centre
    float nearest_pixels_per_meter;
};

CloudView view_of(const CloudTile& tile, const Frustum& frustum) {
    const vec3 center = tile.bounds_camera.center();
    const float distance_m = glm::length(center);
    const float focal_px = frustum.focal_px * off_axis_stretch(frustum, center, distance_m);
    return {{distance_m > 0.0f ? center * (1.0f / distance_m) : vec3(0.0f, 0.0f, -1.0f),
             focal_px / std::max(distance_m, frustum.near_m)},
            focal_px / std::max(tile.nearest_m, frustum.near_m)};
}

}  // namespace

void measure_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                    const FrameSettings& settings, BudgetHistogram& histogram) {
    for (const CloudTile& tile : tiles) {
        const DrawCloud& cloud = geometry.clouds[tile.cloud];
        add_cloud(histogram, cloud.part, cloud.densities, cloud.mean_area_m2, view_of(tile, frustum).view,
                  settings);
    }
}

void expand_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                   const FrameSettings& settings, uint32_t rest_index, WorkPart& work) {
    const float turn = turn_of(rest_index);
    for (const CloudTile& tile : tiles) {
        const DrawCloud& cloud = geometry.clouds[tile.cloud];
        const CloudView seen = view_of(tile, frustum);
        // A tile around the image plane has no depth to go by: all of it is drawn as its nearest place asks for.
        const float depth_m = std::max(glm::dot(frustum.forward, tile.bounds_camera.center()), 0.0f);
        const PartChoice choice = choose_cloud(cloud.part, cloud.densities, cloud.mean_area_m2, seen.view,
                                               depth_m, seen.nearest_pixels_per_meter, settings);
        if (choice.points == 0) continue;
        work.add(cloud.geometry, choice, work.add_instance(instance_of(mat3(1.0f), 1.0f, tile.origin_camera)),
                 turn);
    }
}

uint64_t expand_terrain(const Terrain& terrain, uint32_t first_vertex, dvec3 camera_world,
                        const Frustum& frustum, const FrameSettings& settings, WorkPart& work) {
    const float error_px = ground_error_px(settings);
    vec3 origin = vec3(terrain.origin_world() - camera_world);
    uint32_t instance = work.add_instance(instance_of(mat3(1.0f), 1.0f, origin));
    uint64_t triangles = 0;
    for (const TerrainPatch& patch : terrain.patches()) {
        Box bounds{patch.bounds_local.min + origin, patch.bounds_local.max + origin};
        if (patch.level_count == 0 || see_box(frustum, bounds) == Visibility::outside) continue;
        const TerrainLevel& level =
            terrain.levels()[patch.first_level +
                             choose_ground_level(patch, terrain.levels(), bounds, frustum, error_px)];
        work.add_ground(first_vertex + level.first_vertex, level.vertex_count / 3, instance);
        triangles += level.vertex_count / 3;
    }
    return triangles;
}

}  // namespace coppice
