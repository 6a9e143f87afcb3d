#include "plugins/vegetation/draw/expand_plants.h"

#include <algorithm>
#include <cmath>
#include <utility>
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
                  const PartGeometry& place = geometry.part_geometry[part];
                  work.add(
                      place, choice, instance, turn,
                      first_point_of(plant.model, part - plant.first_part_of_model, place.point_turn_mask));
              });
}

namespace {

struct CloudView {
    float pixels_per_meter;  // at the tile's centre
    float nearest_pixels_per_meter;
};

CloudView view_of(const CloudTile& tile, const Frustum& frustum) {
    const vec3 center = tile.bounds_camera.center();
    const float distance_m = glm::length(center);
    const float focal_px = frustum.focal_px * off_axis_stretch(frustum, center, distance_m);
    return {focal_px / std::max(distance_m, frustum.near_m),
            most_pixels_per_meter(frustum, tile.bounds_camera, tile.nearest_m)};
}

// Of the points that are drawn at most, where the cloud stands in for what is not in memory.
std::span<const float> drawable_densities(const CloudTile& tile, const DrawCloud& cloud,
                                          const CloudView& seen) {
    const float farness = seen.pixels_per_meter / seen.nearest_pixels_per_meter;
    const float most = tile.finest_density * farness * farness;
    const std::span<const float> all = cloud.densities;
    return most == most ? all.first(size_t(std::upper_bound(all.begin(), all.end(), most) - all.begin()))
                        : all;
}

}  // namespace

void measure_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                    const FrameSettings& settings, BudgetHistogram& histogram) {
    for (const CloudTile& tile : tiles) {
        const DrawCloud& cloud = geometry.clouds[tile.cloud];
        const CloudView seen = view_of(tile, frustum);
        add_cloud(histogram, drawable_densities(tile, cloud, seen), seen.pixels_per_meter, settings);
    }
}

void expand_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                   const FrameSettings& settings, WorkPart& work) {
    for (const CloudTile& tile : tiles) {
        const DrawCloud& cloud = geometry.clouds[tile.cloud];
        const CloudView seen = view_of(tile, frustum);
        // Asked for more than the cloud has, it is drawn with larger points until what is nearer has been read.
        FrameSettings tile_settings = settings;
        tile_settings.sample_distance_px =
            std::max(settings.sample_distance_px,
                     seen.nearest_pixels_per_meter *
                         std::sqrt(settings.splat_factor / std::max(tile.finest_density, 1e-12f)));
        // A tile around the image plane has no depth to go by: all of it is drawn as its nearest place asks for.
        const vec3 center = tile.bounds_camera.center();
        const float depth_m = std::max(glm::dot(frustum.forward, center), 0.0f);
        const PartChoice choice =
            choose_cloud(cloud.part, cloud.densities, seen.pixels_per_meter, glm::length(center), depth_m,
                         seen.nearest_pixels_per_meter, tile_settings);
        if (choice.points == 0) continue;
        // From the beginning also at rest: what is asked for is the prefix up to a density.
        work.add(cloud.geometry, choice,
                 work.add_instance(instance_of(mat3(1.0f), 1.0f, tile.origin_camera)));
    }
}

}  // namespace coppice
