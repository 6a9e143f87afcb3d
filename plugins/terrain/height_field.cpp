#include "plugins/terrain/height_field.h"

#include <algorithm>
#include "runtime/core/jobs.h"

namespace coppice {

HeightField::Place HeightField::place_at(float x_local, float z_local) const {
    auto split = [this](float local, uint32_t samples, uint32_t& cell, float& share) {
        float last = float(samples - 1);
        float at = local / cell_m + last * 0.5f;
        if (periodic) at -= std::floor(at / last) * last;
        at = at > 0.0f ? std::min(at, last) : 0.0f;  // NaN: the first sample
        cell = std::min(uint32_t(at), samples - 2);
        share = at - float(cell);
    };
    Place place;
    split(x_local, columns, place.column, place.u);
    split(z_local, rows, place.row, place.v);
    return place;
}

float HeightField::height_at(float x_local, float z_local) const {
    auto [column, row, u, v] = place_at(x_local, z_local);
    float first = sample(column, row), last = sample(column + 1, row + 1);
    if (u > v) {
        float middle = sample(column + 1, row);
        return first + u * (middle - first) + v * (last - middle);
    }
    float middle = sample(column, row + 1);
    return first + v * (middle - first) + u * (last - middle);
}

vec3 normal_of(const HeightField& field, uint32_t column, uint32_t row) {
    const bool on = field.periodic;  // beyond the border
    int64_t west = int64_t(column) - (column > 0 || on), north = int64_t(row) - (row > 0 || on);
    int64_t east = int64_t(column) + (column + 1 < field.columns || on);
    int64_t south = int64_t(row) + (row + 1 < field.rows || on);
    auto height = [&](int64_t i, int64_t j) { return field.heights_m[field.wrapped_sample(i, j)]; };
    float slope_x = (height(east, row) - height(west, row)) / (float(east - west) * field.cell_m);
    float slope_z = (height(column, south) - height(column, north)) / (float(south - north) * field.cell_m);
    return normalize_or(vec3(-slope_x, 1.0f, -slope_z), vec3(0, 1, 0));
}

std::vector<vec3> make_normals(const HeightField& field) {
    std::vector<vec3> normals(field.heights_m.size());
    parallel_for(field.rows, 16, [&](size_t first, size_t last) {
        for (uint32_t row = uint32_t(first); row < last; ++row)
            for (uint32_t column = 0; column < field.columns; ++column)
                normals[size_t(row) * field.columns + column] = normal_of(field, column, row);
    });
    return normals;
}

}  // namespace coppice
