#include "plugins/terrain/height_field.h"

#include <algorithm>
#include "runtime/core/jobs.h"

namespace coppice {

HeightField::Place HeightField::place_at(float x_local, float z_local) const {
    auto split = [this](float local, uint32_t samples, uint32_t& cell, float& share) {
        float last = float(samples - 1);
        float at = local / cell_m + last * 0.5f;
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

std::vector<vec3> make_normals(const HeightField& field) {
    std::vector<vec3> normals(field.heights_m.size());
    parallel_for(field.rows, 16, [&](size_t first, size_t last) {
        for (uint32_t row = uint32_t(first); row < last; ++row)
            for (uint32_t column = 0; column < field.columns; ++column) {
                uint32_t west = column > 0 ? column - 1 : 0, east = std::min(column + 1, field.columns - 1);
                uint32_t north = row > 0 ? row - 1 : 0, south = std::min(row + 1, field.rows - 1);
                float slope_x =
                    (field.sample(east, row) - field.sample(west, row)) / (float(east - west) * field.cell_m);
                float slope_z = (field.sample(column, south) - field.sample(column, north)) /
                                (float(south - north) * field.cell_m);
                normals[size_t(row) * field.columns + column] =
                    normalize_or(vec3(-slope_x, 1.0f, -slope_z), vec3(0, 1, 0));
            }
    });
    return normals;
}

}  // namespace coppice
