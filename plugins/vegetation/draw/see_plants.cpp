#include "plugins/vegetation/draw/see_plants.h"

#include <algorithm>
#include "runtime/core/vector_clones.h"

namespace coppice {
namespace {

constexpr size_t k_block = 64;  // plants looked at together, so that their columns stay in the nearest cache
using Column = std::array<float, k_block>;

// Cells of a plant nearer than 3 radii are looked at from where they are. Farther than 6 no side of the plant is much
// nearer than another, and its parts are drawn in one piece; in between cells are looked at from places that move from
// the plant's centre to their own, so that nothing jumps.
float share_of_own_place(float distance_m, float radius_m) {
    return glm::clamp(2.0f - distance_m / (3.0f * radius_m), 0.0f, 1.0f);
}

inline PlantView view_of(const Frustum& frustum, const mat3& rotation, vec3 center, float distance_m,
                         float radius_m, float scale) {
    return {distance_m > 0.0f ? (center * (1.0f / distance_m)) * rotation : vec3(0.0f, 0.0f, -1.0f),
            pixels_per_meter(frustum.focal_px, distance_m, radius_m, frustum.near_m, scale) *
                off_axis_stretch(frustum, center, distance_m)};
}

struct Block {
    Column x, y, z, scale;                  // of the foot, camera-relative
    Column turn_x, turn_y, turn_z, turn_w;  // PlantTurn, as a unit quaternion
    std::array<uint32_t, k_block> index;    // in the run
    Column reach_m;                         // into the view, past the plane it is nearest to; < 0: outside
    Column center_x, center_y, center_z;    // of the sphere that holds the plant
    Column radius_m, distance_m;
    Column direction_x, direction_y, direction_z, pixels_per_meter;
};

// How far spheres reach into the view.
inline void reach_into_view(const Frustum& frustum, const float* x, const float* y, const float* z,
                            const float* radius_m, float* reach_m, size_t count) {
    for (size_t i = 0; i < count; ++i) reach_m[i] = INFINITY;
    for (uint32_t plane = 0; plane < frustum.plane_count; ++plane) {
        const vec4 n = frustum.planes[plane];
        for (size_t i = 0; i < count; ++i) {
            const float side_m = n.x * x[i] + n.y * y[i] + n.z * z[i] + n.w + radius_m[i];
            reach_m[i] = side_m < reach_m[i] ? side_m : reach_m[i];
        }
    }
}

// Takes the plants [first, first + count) of a run, without those that a sphere around the foot shows to be outside.
COPPICE_VECTOR_CLONES
size_t load_block(const PlantRun& run, size_t first, size_t count, const DrawModel& model,
                  const Frustum& frustum, Block& block) {
    const PlantPosition* places = &run.positions[first];
    const vec3 origin = run.origin_camera;
    for (size_t i = 0; i < count; ++i) {
        block.x[i] = origin.x + places[i].x_tile;
        block.y[i] = origin.y + places[i].y_tile;
        block.z[i] = origin.z + places[i].z_tile;
        block.scale[i] = places[i].scale;
    }
    size_t found = count;
    if (run.inside) {
        for (size_t i = 0; i < count; ++i) block.index[i] = uint32_t(first + i);
    } else {
        for (size_t i = 0; i < count; ++i) block.radius_m[i] = model.foot_radius_m * block.scale[i];
        reach_into_view(frustum, block.x.data(), block.y.data(), block.z.data(), block.radius_m.data(),
                        block.reach_m.data(), count);
        found = 0;
        for (size_t i = 0; i < count; ++i) {
            block.index[found] = uint32_t(first + i);
            block.x[found] = block.x[i];
            block.y[found] = block.y[i];
            block.z[found] = block.z[i];
            block.scale[found] = block.scale[i];
            found += !(block.reach_m[i] < 0.0f);
        }
    }
    for (size_t i = 0; i < found; ++i) {
        const PlantTurn turn = run.turns[block.index[i]];
        block.turn_x[i] = float(turn.x) * k_turn_step;
        block.turn_y[i] = float(turn.y) * k_turn_step;
        block.turn_z[i] = float(turn.z) * k_turn_step;
        block.turn_w[i] = float(turn.w) * k_turn_step;
    }
    return found;
}

// rotation_matrix, view_of and sees_sphere of each, in plain numbers, which compilers make vectors of.
COPPICE_VECTOR_CLONES
void look_at_block(const DrawModel& model, const Frustum& camera, size_t count, Block& b) {
    const Frustum frustum = camera;  // which what is written cannot change
    const float middle_x = model.center_plant.x, middle_y = model.center_plant.y,
                middle_z = model.center_plant.z;
    const float model_radius_m = model.radius_m;
    for (size_t i = 0; i < count; ++i) {
        const float x = b.turn_x[i], y = b.turn_y[i], z = b.turn_z[i], w = b.turn_w[i];
        const float scale = b.scale[i];
        const float xx = 1 - 2 * (y * y + z * z), xy = 2 * (x * y - w * z), xz = 2 * (x * z + w * y);
        const float yx = 2 * (x * y + w * z), yy = 1 - 2 * (x * x + z * z), yz = 2 * (y * z - w * x);
        const float zx = 2 * (x * z - w * y), zy = 2 * (y * z + w * x), zz = 1 - 2 * (x * x + y * y);
        const float from_foot_x = middle_x * scale, from_foot_y = middle_y * scale,
                    from_foot_z = middle_z * scale;
        const float center_x = b.x[i] + (xx * from_foot_x + xy * from_foot_y + xz * from_foot_z);
        const float center_y = b.y[i] + (yx * from_foot_x + yy * from_foot_y + yz * from_foot_z);
        const float center_z = b.z[i] + (zx * from_foot_x + zy * from_foot_y + zz * from_foot_z);
        const float radius_m = model_radius_m * scale;
        const float distance_m = std::sqrt(center_x * center_x + center_y * center_y + center_z * center_z);
        const float per_distance = 1.0f / distance_m;
        const float unit_x = center_x * per_distance, unit_y = center_y * per_distance,
                    unit_z = center_z * per_distance;
        const float direction_x = xx * unit_x + yx * unit_y + zx * unit_z;
        const float direction_y = xy * unit_x + yy * unit_y + zy * unit_z;
        const float direction_z = xz * unit_x + yz * unit_y + zz * unit_z;
        const float along_m =
            frustum.forward.x * center_x + frustum.forward.y * center_y + frustum.forward.z * center_z;
        b.center_x[i] = center_x;
        b.center_y[i] = center_y;
        b.center_z[i] = center_z;
        b.radius_m[i] = radius_m;
        b.distance_m[i] = distance_m;
        b.direction_x[i] = distance_m > 0.0f ? direction_x : 0.0f;
        b.direction_y[i] = distance_m > 0.0f ? direction_y : 0.0f;
        b.direction_z[i] = distance_m > 0.0f ? direction_z : -1.0f;
        b.pixels_per_meter[i] =
            pixels_per_meter(frustum.focal_px, distance_m, radius_m, frustum.near_m, scale) *
            off_axis_stretch(frustum.corner_cos, along_m, distance_m);
    }
    reach_into_view(frustum, b.center_x.data(), b.center_y.data(), b.center_z.data(), b.radius_m.data(),
                    b.reach_m.data(), count);
}

void make_room(SeenPlants& seen, size_t count) {
    if (seen.seed.size() >= count) return;
    for (auto* column : {&seen.direction_x, &seen.direction_y, &seen.direction_z, &seen.pixels_per_meter})
        column->resize(count);
    seen.seed.resize(count);
    seen.in_cells.resize(count);
    seen.instances.resize(count);
}

class Viewer {
  public:
    Viewer(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum, const Horizon* horizon,
           float spread_px, SeenPlants& seen)
        : run_(run),
          geometry_(geometry),
          frustum_(frustum),
          horizon_(horizon),
          spread_px_(spread_px),
          seen_(seen) {}

    // Plants of one model.
    void look_at(size_t first, size_t count, uint32_t model_index) {
        const DrawModel& model = geometry_.models[model_index];
        const size_t found = load_block(run_, first, count, model, frustum_, block_);
        look_at_block(model, frustum_, found, block_);
        const uint32_t first_seen = seen_.plant_count;
        for (size_t i = 0; i < found; ++i) {
            if (!run_.inside && block_.reach_m[i] < 0.0f) continue;
            if (horizon_ && hidden(i)) {
                ++seen_.hidden_plants;
                continue;
            }
            add(i, model);
        }
        const uint32_t count_seen = seen_.plant_count - first_seen;
        seen_.full_triangles += uint64_t(count_seen) * model.triangle_count;
        if (count_seen == 0) return;
        if (!seen_.groups.empty()) {
            SeenGroup& last = seen_.groups.back();
            if (last.model == model_index && seen_.plant_count - last.first <= k_plants_a_batch) {
                last.end = seen_.plant_count;
                return;
            }
        }
        seen_.groups.push_back({model_index, first_seen, seen_.plant_count});
    }

  private:
    vec3 center(size_t i) const { return {block_.center_x[i], block_.center_y[i], block_.center_z[i]}; }

    bool hidden(size_t i) const {
        return horizon_->hidden({center(i) - block_.radius_m[i], center(i) + block_.radius_m[i]}, spread_px_);
    }

    void add(size_t i, const DrawModel& model) {
        const uint32_t at = seen_.plant_count++;
        seen_.direction_x[at] = block_.direction_x[i];
        seen_.direction_y[at] = block_.direction_y[i];
        seen_.direction_z[at] = block_.direction_z[i];
        seen_.pixels_per_meter[at] = block_.pixels_per_meter[i];
        seen_.nearest_m =
            std::min(seen_.nearest_m, estimate_nearest_m(block_.distance_m[i], block_.radius_m[i]));
        seen_.seed[at] = run_.models[block_.index[i]].seed;
        seen_.instances[at] = {block_.x[i],      block_.y[i],      block_.z[i],      block_.scale[i],
                               block_.turn_x[i], block_.turn_y[i], block_.turn_z[i], block_.turn_w[i]};
        if (geometry_.has_tints) set_tint(seen_.instances[at], model.tints.tint_of(seen_.seed[at]));
        const float own_place =
            model.has_cells ? share_of_own_place(block_.distance_m[i], block_.radius_m[i]) : 0.0f;
        seen_.in_cells[at] = own_place > 0.0f;
        if (own_place > 0.0f) add_cells(i, at, model, own_place);
    }

    void add_cells(size_t i, uint32_t plant, const DrawModel& model, float own_place) {
        const mat3 rotation = rotation_matrix(run_.turns[block_.index[i]]);
        const vec3 foot(block_.x[i], block_.y[i], block_.z[i]);
        const float scale = block_.scale[i];
        for (uint32_t part = model.first_part; part < model.first_part + model.part_count; ++part) {
            const PartCells cells = geometry_.part_cells[part];
            for (uint32_t cell = cells.first; cell < cells.first + cells.count; ++cell) {
                const PartSphere& sphere = geometry_.part_spheres[cell];
                const vec3 at = foot + rotation * (sphere.center_plant * scale);
                const float radius_m = sphere.radius_m * scale;
                if (!run_.inside && !sees_sphere(frustum_, at, radius_m)) continue;
                const vec3 from = center(i) + (at - center(i)) * own_place;
                seen_.cells.push_back(
                    {plant, cell, cell - model.first_part,
                     view_of(frustum_, rotation, from, glm::length(from), radius_m, scale)});
            }
        }
    }

    const PlantRun& run_;
    const SceneGeometry& geometry_;
    const Frustum& frustum_;
    const Horizon* horizon_;
    float spread_px_;
    SeenPlants& seen_;
    Block block_;
};

}  // namespace

void see_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                const Horizon* horizon, float spread_px, SeenPlants& seen) {
    seen.plant_count = 0;
    seen.groups.clear();
    seen.cells.clear();
    seen.hidden_plants = 0;
    seen.nearest_m = INFINITY;
    seen.full_triangles = 0;
    make_room(seen, std::max<size_t>(run.positions.size(), k_plants_a_run));
    Viewer viewer(run, geometry, frustum, horizon, spread_px, seen);
    const std::span<const PlantModel> models = run.models;
    for (size_t first = 0; first < models.size();) {
        size_t end = first + 1;
        while (end < models.size() && end - first < k_block && models[end].model == models[first].model)
            ++end;
        viewer.look_at(first, end - first, models[first].model);
        first = end;
    }
}

void measure_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                    BudgetHistogram& histogram) {
    each_part(
        seen, geometry, settings,
        [&](const SeenPart& many) {
            for (size_t i = 0; i < many.left_out.size(); ++i)
                if (!many.left_out[i])
                    add_part(histogram, geometry.parts[many.part], many.rule, many.demands[i], settings);
        },
        [&](uint32_t, uint32_t part, uint32_t, const PartRule& rule, const PartDemand& demand) {
            add_part(histogram, geometry.parts[part], rule, demand, settings);
        });
}

}  // namespace coppice
