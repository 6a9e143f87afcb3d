#include "plugins/vegetation/draw/see_plants.h"

#include <algorithm>

namespace coppice {
namespace {

// Cells of a plant nearer than 3 radii are looked at from where they are. Farther than 6 no side of the plant is much
// nearer than another, and its parts are drawn in one piece; in between cells are looked at from places that move from
// the plant's centre to their own, so that nothing jumps.
float share_of_own_place(const DrawModel& model, float distance_m, float scale) {
    return model.has_cells ? glm::clamp(2.0f - distance_m / (3.0f * model.radius_m * scale), 0.0f, 1.0f)
                           : 0.0f;
}

inline PlantView view_of(const Frustum& frustum, const mat3& rotation, vec3 center, float distance_m,
                         float radius_m, float scale) {
    return {distance_m > 0.0f ? (center * (1.0f / distance_m)) * rotation : vec3(0.0f, 0.0f, -1.0f),
            pixels_per_meter(frustum.focal_px, distance_m, radius_m, frustum.near_m, scale) *
                off_axis_stretch(frustum, center, distance_m)};
}

// Which plants of a block may be in view: by a sphere around the foot, in loops that compilers make vectors of, before
// anything is turned. Most plants of a tile across the border of the view are left out by it.
class NearView {
  public:
    // Indices into the block, ascending. Requires at most k_plants_a_run plants.
    std::span<const uint16_t> find(const PlantRun& run, size_t first, size_t count,
                                   const SceneGeometry& geometry, const Frustum& frustum) {
        for (size_t i = 0; i < count; ++i) {
            const PlantPosition& place = run.positions[first + i];
            x_[i] = run.origin_camera.x + place.x_tile;
            y_[i] = run.origin_camera.y + place.y_tile;
            z_[i] = run.origin_camera.z + place.z_tile;
            radius_m_[i] = geometry.models[run.models[first + i].model].foot_radius_m * place.scale;
        }
        const vec3 f = frustum.forward;
        for (size_t i = 0; i < count; ++i)
            reach_m_[i] = f.x * x_[i] + f.y * y_[i] + f.z * z_[i] - frustum.near_m + radius_m_[i];
        for (const vec3& n : frustum.side_normals)
            for (size_t i = 0; i < count; ++i) {
                const float reach_m = n.x * x_[i] + n.y * y_[i] + n.z * z_[i] + radius_m_[i];
                reach_m_[i] = reach_m < reach_m_[i] ? reach_m : reach_m_[i];
            }
        size_t found = 0;
        for (size_t i = 0; i < count; ++i) {
            found_[found] = uint16_t(i);
            found += !(reach_m_[i] < 0.0f);
        }
        return {found_, found};
    }
    std::span<const uint16_t> all(size_t count) {
        for (size_t i = 0; i < count; ++i) found_[i] = uint16_t(i);
        return {found_, count};
    }

  private:
    float x_[k_plants_a_run], y_[k_plants_a_run], z_[k_plants_a_run];
    float radius_m_[k_plants_a_run],
        reach_m_[k_plants_a_run];  // reach: into the view, past the nearest plane
    uint16_t found_[k_plants_a_run];
};

}  // namespace

void see_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                const FrameSettings& settings, const Horizon* horizon, float spread_px, SeenPlants& seen) {
    seen.plants.clear();
    seen.parts.clear();
    seen.hidden_plants = 0;
    seen.full_triangles = 0;
    auto add = [&](uint32_t part, const PlantView& view) {
        seen.parts.push_back({part, settings.level_of_detail
                                        ? project_part(geometry.parts[part], view, settings)
                                        : PartProjection{}});
    };
    auto look_at = [&](size_t i) {
        const PlantPosition& place = run.positions[i];
        const DrawModel& model = geometry.models[run.models[i].model];
        const mat3 rotation = rotation_matrix(run.turns[i]);
        const vec3 position = run.origin_camera + vec3(place.x_tile, place.y_tile, place.z_tile);
        const vec3 center = position + rotation * (model.center_plant * place.scale);
        const float radius_m = model.radius_m * place.scale;
        if (!run.inside && !sees_sphere(frustum, center, radius_m)) return;
        if (horizon && horizon->hidden({center - radius_m, center + radius_m}, spread_px)) {
            ++seen.hidden_plants;
            return;
        }
        seen.full_triangles += model.triangle_count;

        const float distance_m = glm::length(center);
        const PlantView plant_view = view_of(frustum, rotation, center, distance_m, radius_m, place.scale);
        const float own_place = share_of_own_place(model, distance_m, place.scale);
        for (uint32_t part = model.first_part; part < model.first_part + model.part_count; ++part) {
            const PartCells cells = geometry.part_cells[part];
            if (cells.count == 0 || own_place == 0.0f) {
                add(part, plant_view);
                continue;
            }
            for (uint32_t cell = cells.first; cell < cells.first + cells.count; ++cell) {
                const PartSphere& sphere = geometry.part_spheres[cell];
                const vec3 at = position + rotation * (sphere.center_plant * place.scale);
                const float cell_radius_m = sphere.radius_m * place.scale;
                if (!run.inside && !sees_sphere(frustum, at, cell_radius_m)) continue;
                const vec3 from = center + (at - center) * own_place;
                add(cell, view_of(frustum, rotation, from, glm::length(from), cell_radius_m, place.scale));
            }
        }
        seen.plants.push_back({instance_of(rotation, place.scale, position), plant_view, model.first_part,
                               run.models[i], uint32_t(seen.parts.size())});
    };
    NearView near;
    for (size_t first = 0; first < run.positions.size(); first += k_plants_a_run) {
        const size_t count = std::min<size_t>(k_plants_a_run, run.positions.size() - first);
        for (uint16_t i : run.inside ? near.all(count) : near.find(run, first, count, geometry, frustum))
            look_at(first + i);
    }
}

void measure_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                    BudgetHistogram& histogram) {
    each_part(seen, geometry, settings,
              [&](const SeenPlant&, uint32_t part, const PartProjection& projected) {
                  add_part(histogram, geometry.parts[part], projected, settings);
              });
}

}  // namespace coppice
