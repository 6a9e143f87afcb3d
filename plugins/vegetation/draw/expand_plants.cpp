#include "plugins/vegetation/draw/expand_plants.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/eco/part_chance.h"

namespace coppice {
namespace {

// Cells of a plant nearer than 3 radii are looked at from where they are. Farther than 6 no side of the plant is much
// nearer than another, and its parts are drawn in one piece; in between cells are looked at from places that move from
// the plant's centre to their own, so that nothing jumps.
float share_of_own_place(const DrawModel& model, float distance_m, float scale) {
    return model.has_cells ? glm::clamp(2.0f - distance_m / (3.0f * model.radius_m * scale), 0.0f, 1.0f)
                           : 0.0f;
}

PlantView view_of(const Frustum& frustum, const mat3& rotation, vec3 center, float radius_m, float scale) {
    const float distance_m = glm::length(center);
    return {distance_m > 0.0f ? (center * (1.0f / distance_m)) * rotation : vec3(0.0f, 0.0f, -1.0f),
            pixels_per_meter(frustum.focal_px, distance_m, radius_m, frustum.near_m, scale) *
                off_axis_stretch(frustum, center, distance_m)};
}

// Multiples of the golden section.
float turn_of(uint32_t rest_index) { return float(uint32_t(rest_index * 2654435769u) >> 8) * 0x1p-24f; }

}  // namespace

ExpandCounts expand_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                           const FrameSettings& settings, uint32_t rest_index, WorkPart& work) {
    ExpandCounts counts;
    const float turn = turn_of(rest_index);
    for (size_t i = 0; i < run.positions.size(); ++i) {
        const PlantPosition& place = run.positions[i];
        const DrawModel& model = geometry.models[run.models[i].model];
        mat3 rotation = rotation_matrix(run.turns[i]);
        vec3 position = run.origin_camera + vec3(place.x_tile, place.y_tile, place.z_tile);
        vec3 center = position + rotation * (model.center_plant * place.scale);
        if (!run.inside && !sees_sphere(frustum, center, model.radius_m * place.scale)) continue;
        ++counts.plants_visible;
        counts.full_triangles += model.triangle_count;

        const PlantView plant_view =
            view_of(frustum, rotation, center, model.radius_m * place.scale, place.scale);
        const float own_place = share_of_own_place(model, glm::length(center), place.scale);
        uint32_t instance = UINT32_MAX;
        auto choose = [&](uint32_t part, const PlantView& view) {
            float chance = part_chance(run.models[i], part - model.first_part) + turn;
            if (chance >= 1.0f) chance -= 1.0f;
            return choose_part(geometry.parts[part], view, settings, chance);
        };
        auto draw = [&](uint32_t part, const PartChoice& choice) {
            if ((choice.triangles | choice.points | choice.lines) == 0) return;
            if (instance == UINT32_MAX)
                instance = work.add_instance(instance_of(rotation, place.scale, position));
            work.add(geometry.part_geometry[part], choice, instance, turn);
        };
        for (uint32_t part = model.first_part; part < model.first_part + model.part_count; ++part) {
            const PartCells cells = geometry.part_cells[part];
            if (cells.count == 0 || own_place == 0.0f) {
                const PartChoice choice = choose(part, plant_view);
                // Only cells have points to go on with where the part's are used up, and blend.
                if (cells.count == 0 || choice.triangles == 0 || !settings.level_of_detail) {
                    draw(part, choice);
                    continue;
                }
            }
            for (uint32_t cell = cells.first; cell < cells.first + cells.count; ++cell) {
                PlantView view = plant_view;
                if (own_place > 0.0f) {
                    const PartSphere& sphere = geometry.part_spheres[cell];
                    const vec3 at = position + rotation * (sphere.center_plant * place.scale);
                    const float radius_m = sphere.radius_m * place.scale;
                    if (!run.inside && !sees_sphere(frustum, at, radius_m)) continue;
                    view =
                        view_of(frustum, rotation, center + (at - center) * own_place, radius_m, place.scale);
                }
                draw(cell, choose(cell, view));
            }
        }
    }
    return counts;
}

void expand_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                   const FrameSettings& settings, uint32_t rest_index, WorkPart& work) {
    const float turn = turn_of(rest_index);
    for (const CloudTile& tile : tiles) {
        const DrawCloud& cloud = geometry.clouds[tile.cloud];
        const vec3 center = tile.bounds_camera.center();
        const float distance_m = glm::length(center);
        const float stretch = off_axis_stretch(frustum, center, distance_m);
        PlantView view;
        view.pixels_per_meter = frustum.focal_px / std::max(distance_m, frustum.near_m) * stretch;
        view.direction_plant = distance_m > 0.0f ? center * (1.0f / distance_m) : vec3(0.0f, 0.0f, -1.0f);
        const float nearest_pixels_per_meter =
            frustum.focal_px / std::max(tile.nearest_m, frustum.near_m) * stretch;
        // Asked for more than the cloud has, it is drawn with larger points until what is nearer has been read.
        FrameSettings tile_settings = settings;
        tile_settings.sample_distance_px =
            std::max(settings.sample_distance_px,
                     nearest_pixels_per_meter / std::sqrt(std::max(tile.finest_density, 1e-12f)));
        // A tile around the image plane has no depth to go by: all of it is drawn as its nearest place asks for.
        const float depth_m = std::max(glm::dot(frustum.forward, center), 0.0f);
        const PartChoice choice = choose_cloud(cloud.part, cloud.densities, cloud.mean_area_m2, view, depth_m,
                                               nearest_pixels_per_meter, tile_settings);
        if (choice.points == 0) continue;
        work.add(cloud.geometry, choice, work.add_instance(instance_of(mat3(1.0f), 1.0f, tile.origin_camera)),
                 turn);
    }
}

}  // namespace coppice
