#include "plugins/vegetation/draw/expand_plants.h"

#include <algorithm>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

WorkInstance instance_of(const mat3& rotation, float scale, vec3 position) {
    WorkInstance instance{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) instance.rows[row][column] = rotation[column][row] * scale;
        instance.rows[row][3] = position[row];
    }
    return instance;
}

}  // namespace

ExpandCounts expand_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                           const FrameSettings& settings, uint32_t rest_index, WorkPart& work) {
    ExpandCounts counts;
    const float turn =
        float(uint32_t(rest_index * 2654435769u) >> 8) * 0x1p-24f;  // multiples of the golden section
    for (size_t i = 0; i < run.positions.size(); ++i) {
        const PlantPosition& place = run.positions[i];
        const DrawModel& model = geometry.models[run.models[i].model];
        mat3 rotation = rotation_matrix(run.turns[i]);
        vec3 position = run.origin_camera + vec3(place.x_tile, place.y_tile, place.z_tile);
        vec3 center = position + rotation * (model.center_plant * place.scale);
        if (!run.inside && !sees_sphere(frustum, center, model.radius_m * place.scale)) continue;
        ++counts.plants_visible;
        counts.full_triangles += model.triangle_count;

        float distance_m = glm::length(center);
        PlantView view;
        view.pixels_per_meter = pixels_per_meter(frustum.focal_px, distance_m, model.radius_m * place.scale,
                                                 frustum.near_m, place.scale) *
                                off_axis_stretch(frustum, center, distance_m);
        view.direction_plant =
            distance_m > 0.0f ? (center * (1.0f / distance_m)) * rotation : vec3(0.0f, 0.0f, -1.0f);
        uint32_t instance = UINT32_MAX;
        for (uint32_t p = 0; p < model.part_count; ++p) {
            uint32_t part = model.first_part + p;
            float chance = float(mix_bits(run.models[i].seed + p * 0x9e3779b9u) >> 8) * 0x1p-24f + turn;
            if (chance >= 1.0f) chance -= 1.0f;
            PartChoice choice = choose_part(geometry.parts[part], view, settings, chance);
            if ((choice.triangles | choice.points | choice.lines) == 0) continue;
            if (instance == UINT32_MAX)
                instance = work.add_instance(instance_of(rotation, place.scale, position));
            work.add(geometry.part_geometry[part], choice, instance, turn);
        }
    }
    return counts;
}

uint64_t expand_terrain(const Terrain& terrain, uint32_t first_vertex, dvec3 camera_world,
                        const Frustum& frustum, const FrameSettings& settings, WorkPart& work) {
    const float error_px = settings.level_of_detail ? 1.0f : 0.0f;
    vec3 origin = vec3(terrain.origin_world() - camera_world);
    uint32_t instance = work.add_instance(instance_of(mat3(1.0f), 1.0f, origin));
    uint64_t triangles = 0;
    for (const TerrainPatch& patch : terrain.patches()) {
        Box bounds{patch.bounds_local.min + origin, patch.bounds_local.max + origin};
        if (patch.level_count == 0 || see_box(frustum, bounds) == Visibility::outside) continue;
        float distance_m =
            std::max(glm::length(glm::clamp(vec3(0.0f), bounds.min, bounds.max)), frustum.near_m);
        auto levels = terrain.levels().subspan(patch.first_level, patch.level_count);
        size_t level = levels.size() - 1;
        while (level > 0 && levels[level].error_m * frustum.focal_px > error_px * distance_m) --level;
        work.add_ground(first_vertex + levels[level].first_vertex, levels[level].vertex_count / 3, instance);
        triangles += levels[level].vertex_count / 3;
    }
    return triangles;
}

}  // namespace coppice
