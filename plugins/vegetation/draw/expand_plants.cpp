#include "plugins/vegetation/draw/expand_plants.h"

#include <algorithm>
#include <cmath>
#include "runtime/core/vector_clones.h"

namespace coppice {
namespace {

COPPICE_VECTOR_CLONES
void chances_of(std::span<const uint32_t> seeds, uint32_t part_of_model, float turn,
                PlantColumn<float>& out) {
    const size_t count = std::min(seeds.size(), out.size());
    for (size_t i = 0; i < count; ++i) out[i] = turned_chance(seeds[i], part_of_model, turn);
}

COPPICE_VECTOR_CLONES
void first_points_of(std::span<const uint32_t> seeds, uint32_t part_of_model, uint32_t mask,
                     PlantColumn<uint32_t>& out) {
    const size_t count = std::min(seeds.size(), out.size());
    for (size_t i = 0; i < count; ++i) out[i] = first_point_of(seeds[i], part_of_model, mask);
}

}  // namespace

void draw_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                 uint32_t rest_index, WorkPart& work) {
    const float turn = rest_turn(rest_index);
    work.share_instances(std::span(seen.instances).first(seen.plant_count));
    PlantColumn<float> chances;
    PlantColumn<uint32_t> first_points;
    PartChoices choices;
    each_part(
        seen, geometry, settings,
        [&](const SeenPart& many) {
            const size_t count = many.left_out.size();
            const std::span<const uint32_t> seeds = std::span(seen.seed).subspan(many.first_plant, count);
            const PartGeometry& place = geometry.part_geometry[many.part];
            chances_of(seeds, many.part_of_model, turn, chances);
            first_points_of(seeds, many.part_of_model, place.point_turn_mask, first_points);
            choose_parts(many.rule, many.demands, std::span(chances).first(count), choices);
            work.add(place, many.rule, many.demands, choices, first_points, many.left_out, many.first_plant,
                     turn);
        },
        [&](uint32_t plant, uint32_t part, uint32_t part_of_model, const PartRule& rule,
            const PartDemand& demand) {
            const float chance = turned_chance(seen.seed[plant], part_of_model, turn);
            const PartGeometry& place = geometry.part_geometry[part];
            work.add(place, rule.expand(rule.choose(demand, chance), demand.side_gain), plant, turn,
                     first_point_of(seen.seed[plant], part_of_model, place.point_turn_mask),
                     demand.pixels_per_meter);
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
        const float distance_m = std::max(glm::length(center), frustum.near_m);
        const float depth_m = frustum.corner_cos < 1.0f ? std::max(glm::dot(frustum.forward, center), 0.0f)
                                                        : distance_m;  // it looks everywhere
        const PartChoice choice =
            choose_cloud(cloud.part, cloud.densities, seen.pixels_per_meter, distance_m, depth_m,
                         seen.nearest_pixels_per_meter, tile_settings);
        if (choice.points == 0) continue;
        // From the beginning also at rest: what is asked for is the prefix up to a density.
        work.add(cloud.geometry, choice, work.add_instance(instance_at(tile.origin_camera)));
    }
}

}  // namespace coppice
