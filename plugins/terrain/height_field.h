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
    std::vector<float> heights_m;  // rows * columns, row by row from least z

    // Local coordinates: the middle of the field is x = z = 0.
    float x_of(uint32_t column) const { return (float(column) - float(columns - 1) * 0.5f) * cell_m; }
    float z_of(uint32_t row) const { return (float(row) - float(rows - 1) * 0.5f) * cell_m; }
    float sample(uint32_t column, uint32_t row) const { return heights_m[size_t(row) * columns + column]; }
    // Outside the field the border's heights hold.
    float height_at(float x_local, float z_local) const;
    // The cell a place is in and where in it, both in [0, 1]; clamped to the field.
    struct Place {
        uint32_t column, row;
        float u, v;
    };
    Place place_at(float x_local, float z_local) const;
};

inline constexpr uint32_t k_terrain_side_limit = 8193;          // samples
inline constexpr uint32_t k_terrain_cell_limit = 4u * 1048576;  // about 128 bytes of triangles each

// One normal a sample, from central differences. Unit.
std::vector<vec3> make_normals(const HeightField& field);

}  // namespace coppice
