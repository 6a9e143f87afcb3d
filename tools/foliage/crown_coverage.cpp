#include "tools/foliage/crown_coverage.h"

#include <algorithm>
#include "plugins/vegetation/cook/coverage_raster.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr uint32_t k_side_px = 700;
constexpr float k_filled = 0.8f;  // of the picture, by the crown's diagonal: joined leaves may reach past it

// Spread over the upper half of the sphere, from beside to above: from opposite sides the same is covered.
vec3 direction(size_t i) {
    constexpr float k_turn_rad = 2.39996323f, k_first_rad = 1.0f;
    const float y = (float(i) + 0.5f) / float(CrownCoverage::k_direction_count);
    const float across = std::sqrt(1.0f - y * y), around = k_first_rad + float(i) * k_turn_rad;
    return {across * portable_cos(around), y, across * portable_sin(around)};
}

}  // namespace

CrownCoverage::CrownCoverage(std::span<const Leaf> crown) {
    for (const Leaf& leaf : crown)
        for (vec3 corner : leaf.corners_plant) box_.include(corner);
    full_ = count(crown);
}

double CrownCoverage::worst_error(std::span<const Leaf> leaves) const {
    const Pixels now = count(leaves);
    double worst = 0.0;
    for (size_t i = 0; i < k_direction_count; ++i)
        if (full_[i] > 0) worst = std::max(worst, std::abs(double(now[i]) / double(full_[i]) - 1.0));
    return worst;
}

CrownCoverage::Pixels CrownCoverage::count(std::span<const Leaf> leaves) const {
    Pixels pixels{};
    if (box_.empty()) return pixels;
    const float scale = k_filled * float(k_side_px) / std::max(glm::length(box_.size()), 1e-20f);
    parallel_for(k_direction_count, 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const vec3 d = direction(i), x = perpendicular_to(d), y = glm::cross(d, x);
            CoverageRaster raster(k_side_px);
            raster.begin();
            for (const Leaf& leaf : leaves) {
                std::array<vec3, 4> p;
                for (size_t k = 0; k < 4; ++k) {
                    const vec3 away = (leaf.corners_plant[k] - box_.center()) * scale;
                    p[k] = vec3(glm::dot(away, x), glm::dot(away, y), 0.0f) + 0.5f * float(k_side_px);
                }
                raster.triangle(p[0], p[1], p[2]);
                raster.triangle(p[0], p[2], p[3]);
            }
            pixels[i] = raster.covered();
        }
    });
    return pixels;
}

}  // namespace coppice
