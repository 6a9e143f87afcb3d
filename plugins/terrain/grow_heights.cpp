#include "plugins/terrain/grow_heights.h"

#include "plugins/terrain/build_patches.h"
#include "plugins/shared/noise.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

float natural_height(const GrowHeightsSettings& s, const Region& valley, double x, double z) {
    double u = x / double(s.wavelength_m), v = z / double(s.wavelength_m);
    double period = s.periodic ? double(s.size_m) / double(s.wavelength_m) : 0.0;
    float hills = fractal_noise(u, v, s.octaves, s.roughness, s.seed, period);
    if (s.ridges > 0.0f) {
        float crest = 1.0f - 2.5f * std::fabs(fractal_noise(u * 0.7, v * 0.7, s.octaves, s.roughness,
                                                            s.seed + 77u, period * 0.7));
        hills += s.ridges * (0.5f * crest - hills);
    }
    float trough = 0.0f;
    if (!valley.shapes.empty())
        trough = 1.0f - smooth_step(0.0f, s.valley_width_m * 0.5f, float(valley.distance_m(dvec2(x, z))));
    // Between the square's distance and the circle's: the rim has no crease along the diagonals.
    double x2 = x * x, z2 = z * z;
    float border = float(std::sqrt(std::sqrt(x2 * x2 + z2 * z2)) / (0.5 * double(s.size_m)));
    return s.amplitude_m * hills * 2.0f * (1.0f - 0.75f * trough) - s.valley_depth_m * trough +
           s.rim_m * smooth_step(0.35f, 1.0f, border);
}

}  // namespace

uint32_t cells_along(float size_m, float cell_m) {
    return uint32_t(std::ceil(size_m / cell_m / float(k_patch_cells))) * k_patch_cells;
}

HeightField grow_heights(const GrowHeightsSettings& s) {
    HeightField field;
    uint32_t cells = cells_along(s.size_m, s.cell_m);
    field.columns = field.rows = cells + 1;
    field.cell_m = s.size_m / float(cells);
    field.periodic = s.periodic;
    field.heights_m.resize(size_t(field.columns) * field.rows);
    Region valley;
    if (s.valley.size() >= 2) {
        RegionShape line;
        line.kind = RegionShape::Kind::corridor;
        line.points = s.valley;
        valley.shapes.push_back(std::move(line));
    }
    float level_m =
        s.level_radius_m > 0.0f ? natural_height(s, valley, s.level_center.x, s.level_center.y) : 0.0f;
    parallel_for(field.rows, 8, [&](size_t first, size_t last) {
        for (uint32_t row = uint32_t(first); row < last; ++row)
            for (uint32_t column = 0; column < field.columns; ++column) {
                double x = double(field.x_of(column)), z = double(field.z_of(row));
                float height = natural_height(s, valley, x, z);
                if (s.level_radius_m > 0.0f) {
                    float away = float(glm::length(dvec2(x, z) - s.level_center)) / s.level_radius_m;
                    height += 0.85f * (1.0f - smooth_step(0.3f, 1.0f, away)) * (level_m - height);
                }
                field.heights_m[size_t(row) * field.columns + column] = height;
            }
    });
    repeat_border(field, field.heights_m);
    return field;
}

}  // namespace coppice
