#include "plugins/terrain/field_terrain.h"

#include <algorithm>
#include <cmath>
#include "plugins/shared/noise.h"

namespace coppice {

FieldTerrain::FieldTerrain(HeightField field, GroundSettings settings, dvec3 origin_world)
    : field_(std::move(field)),
      mesh_(build_patches(field_)),
      origin_world_(origin_world),
      bounds_local_(mesh_.bounds()),
      settings_(std::move(settings)),
      light_(field_.heights_m.size(), 1.0f) {}

FieldTerrain::FieldTerrain(PackedGround packed, dvec3 origin_world)
    : field_(std::move(packed.field)),
      mesh_(std::move(packed.mesh)),
      origin_world_(origin_world),
      bounds_local_(mesh_.bounds()),
      words_(std::move(packed.words)) {}

vec3 FieldTerrain::normal_at(float x_local, float z_local) const {
    const auto [column, row, u, v] = field_.place_at(x_local, z_local);
    const vec3 north_west = normal_of(field_, column, row), south_west = normal_of(field_, column, row + 1);
    const vec3 north = north_west + (normal_of(field_, column + 1, row) - north_west) * u;
    const vec3 south = south_west + (normal_of(field_, column + 1, row + 1) - south_west) * u;
    return normalize_or(north + (south - north) * v, vec3(0, 1, 0));
}

const std::vector<uint32_t>& FieldTerrain::words() const {
    if (words_.empty()) {
        GroundSurface ground;
        ground.normals = make_normals(field_);
        ground.colors_linear = color_ground(field_, ground.normals, *settings_, origin_world_);
        ground.light = light_;
        words_ = color_levels(field_, ground, mesh_);
    }
    return words_;
}

std::span<const PackedVertex> FieldTerrain::vertices() const {
    std::lock_guard lock(mutex_);
    if (vertices_.empty()) {
        vertices_.resize(mesh_.vertex_count);
        coppice::write_vertices(field_, mesh_, words(), vertices_);
    }
    return vertices_;
}

void FieldTerrain::write_vertices(std::span<PackedVertex> all) const {
    std::lock_guard lock(mutex_);
    coppice::write_vertices(field_, mesh_, words(), all);
}

void FieldTerrain::write_level(uint32_t level, std::span<PackedVertex> of_level) const {
    std::lock_guard lock(mutex_);
    coppice::write_level(field_, mesh_, level, words(), of_level);
}

PackedTerrain FieldTerrain::pack() const {
    std::lock_guard lock(mutex_);
    return pack_ground(field_, words());
}

void FieldTerrain::shade(float x_local, float z_local, float radius_m, float amount) {
    if (!settings_ || !(radius_m > 0.0f) || !std::isfinite(x_local) || !std::isfinite(z_local)) return;
    constexpr float k_darkest = 0.18f;  // under any number of crowns
    amount = amount > 0.0f ? std::min(amount, 1.0f) : 0.0f;
    // What is smaller than a cell darkens the nearest samples in proportion to its area.
    float reach_m = std::min(std::max(radius_m, field_.cell_m * 1.25f), 1000.0f);
    amount *= std::min(1.0f, (radius_m / reach_m) * (radius_m / reach_m));
    float column_mid = x_local / field_.cell_m + float(field_.columns - 1) * 0.5f;
    float row_mid = z_local / field_.cell_m + float(field_.rows - 1) * 0.5f;
    float reach = reach_m / field_.cell_m;
    auto first = [](float at) { return at > 0.0f ? int64_t(std::min(at, 1e6f)) + 1 : int64_t(0); };
    auto last = [](float at, uint32_t count) {
        return at < 0.0f ? -1 : int64_t(std::min(at, float(count - 1)));
    };
    int64_t column_first = first(column_mid - reach), column_last = last(column_mid + reach, field_.columns);
    int64_t row_first = first(row_mid - reach), row_last = last(row_mid + reach, field_.rows);
    if (field_.periodic) {  // the shade goes on beyond the border
        auto middle = [](float at, uint32_t count) {
            at = std::fmod(at, float(count - 1));
            return at < 0.0f ? at + float(count - 1) : at;
        };
        column_mid = middle(column_mid, field_.columns);
        row_mid = middle(row_mid, field_.rows);
        reach = std::min(reach, 0.49f * float(std::min(field_.columns, field_.rows) - 1));
        column_first = int64_t(std::floor(column_mid - reach)) + 1;
        column_last = int64_t(std::floor(column_mid + reach));
        row_first = int64_t(std::floor(row_mid - reach)) + 1;
        row_last = int64_t(std::floor(row_mid + reach));
    }
    std::lock_guard lock(mutex_);
    for (int64_t row = row_first; row <= row_last; ++row)
        for (int64_t column = column_first; column <= column_last; ++column) {
            float dx = float(column) - column_mid, dz = float(row) - row_mid;
            float away = std::sqrt(dx * dx + dz * dz) / reach;
            float& light = light_[field_.wrapped_sample(column, row)];
            light = std::max(k_darkest, light * (1.0f - amount * (1.0f - smooth_step(0.35f, 1.0f, away))));
        }
    if (column_first <= 0 || row_first <= 0 || column_last + 1 >= field_.columns ||
        row_last + 1 >= field_.rows)
        repeat_border(field_, light_);
    words_ = {};
    vertices_ = {};
}

}  // namespace coppice
