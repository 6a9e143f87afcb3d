// Heights on a grid of equal cells, and the surface they mean: every cell is two triangles, cut from its
// corner of least x and z to that of greatest. Drawn, sampled and stood upon alike.
#pragma once
#include <cstdint>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

struct HeightField {
    uint32_t columns = 0, rows = 0;  // samples along x and z, at least 2
    float cell_m = 1.0f;
    // The field goes on beside itself: samples of opposite borders are the same place and have the same height.
    bool periodic = false;
    std::vector<float> heights_m;  // rows * columns, row by row from least z

    // Local coordinates: the middle of the field is x = z = 0.
    float x_of(uint32_t column) const { return (float(column) - float(columns - 1) * 0.5f) * cell_m; }
    float z_of(uint32_t row) const { return (float(row) - float(rows - 1) * 0.5f) * cell_m; }
    float sample(uint32_t column, uint32_t row) const { return heights_m[size_t(row) * columns + column]; }
    // Columns and rows outside a periodic field are brought back into it; of another there must be none.
    size_t wrapped_sample(int64_t column, int64_t row) const {
        if (periodic) column = wrapped(column, columns), row = wrapped(row, rows);
        return size_t(row) * columns + size_t(column);
    }
    // Outside the field the border's heights hold, or it goes on.
    float height_at(float x_local, float z_local) const;
    // The cell a place is in and where in it, both in [0, 1]; clamped to the field, or brought back into it.
    struct Place {
        uint32_t column, row;
        float u, v;
    };
    Place place_at(float x_local, float z_local) const;

  private:
    static int64_t wrapped(int64_t at, uint32_t samples) {
        const int64_t period = int64_t(samples) - 1;
        return (at % period + period) % period;
    }
};

inline constexpr uint32_t k_terrain_side_limit = 8193;          // samples
inline constexpr uint32_t k_terrain_cell_limit = 4u * 1048576;  // about 128 bytes of triangles each

// What samples of opposite borders of a periodic field have is made equal: the noise it comes from repeats but for rounding.
template <typename Value>
void repeat_border(const HeightField& field, std::vector<Value>& values) {
    if (!field.periodic) return;
    auto repeat = [&](uint32_t column, uint32_t row) {
        values[size_t(row) * field.columns + column] = values[field.wrapped_sample(column, row)];
    };
    for (uint32_t row = 0; row < field.rows; ++row) repeat(field.columns - 1, row);
    for (uint32_t column = 0; column < field.columns; ++column) repeat(column, field.rows - 1);
}

// Of a sample, from central differences; across the border where the field is periodic. Unit.
vec3 normal_of(const HeightField& field, uint32_t column, uint32_t row);
// One normal a sample.
std::vector<vec3> make_normals(const HeightField& field);

}  // namespace coppice
