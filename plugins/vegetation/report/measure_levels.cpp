#include "plugins/vegetation/report/measure_levels.h"

#include <algorithm>
#include <cmath>
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr int k_directions = 16, k_shifts = 4;

struct Means {
    double coverage_px = 0.0;
    dvec3 color{0.0};  // of what is covered
    PrimitiveCounts drawn;
};

Result<Means> mean_over_directions(PlantPicture& picture, float height_px, const FrameSettings& settings) {
    Means means;
    Random random(1);
    for (int i = 0; i < k_directions; ++i) {
        const float yaw_rad = 2.0f * k_pi * 0.618034f * float(i), pitch_rad = -0.35f * float(i % 4);
        for (int shift = 0; shift < k_shifts; ++shift) {
            const float x = random.next_unit(), y = random.next_unit();
            COPPICE_TRY(const PictureMean mean, picture.draw(height_px, yaw_rad, pitch_rad, {x, y}, settings));
            means.coverage_px += mean.coverage_px;
            means.color += dvec3(mean.color_linear) * mean.coverage_px;
            means.drawn.triangles += picture.work().triangles;
            means.drawn.lines += picture.work().lines;
            means.drawn.points += picture.work().points;
            means.drawn.leaves += picture.work().leaves;
        }
    }
    if (means.coverage_px > 0.0) means.color /= means.coverage_px;
    constexpr uint64_t k_draws = k_directions * k_shifts;
    means.coverage_px /= double(k_draws);
    for (auto* count : {&means.drawn.triangles, &means.drawn.lines, &means.drawn.points, &means.drawn.leaves})
        *count /= k_draws;
    return means;
}

}  // namespace

Result<LevelFigures> measure_levels(PlantPicture& picture, float height_px, const FrameSettings& settings) {
    FrameSettings all = settings;
    all.level_of_detail = false;
    COPPICE_TRY(const Means full, mean_over_directions(picture, height_px, all));
    COPPICE_TRY(const Means level, mean_over_directions(picture, height_px, settings));
    LevelFigures figures{height_px, full.coverage_px, 0.0, 0.0, full.drawn, level.drawn};
    if (!(full.coverage_px > 0.0)) return figures;
    figures.coverage_error = level.coverage_px / full.coverage_px - 1.0;
    const double brightness = (full.color.x + full.color.y + full.color.z) / 3.0;
    const dvec3 off = glm::abs(level.color - full.color);
    if (brightness > 0.0 && level.coverage_px > 0.0)
        figures.color_error = std::max({off.x, off.y, off.z}) / brightness;
    return figures;
}

}  // namespace coppice
