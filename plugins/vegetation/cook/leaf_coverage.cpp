#include "plugins/vegetation/cook/leaf_coverage.h"

#include <algorithm>
#include "plugins/vegetation/cook/coverage_raster.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr uint32_t k_side_px = 256;
constexpr float k_filled = 0.9f;  // of the picture, by the crown's sphere: joined leaves may reach past it

// A spiral over the upper half of the sphere: from opposite sides the same is covered.
vec3 direction(size_t i, size_t count) {
    const float y = (float(i) + 0.5f) / float(count), across = std::sqrt(1.0f - y * y);
    const float around = float(i) * 2.39996323f;
    return {across * portable_cos(around), y, across * portable_sin(around)};
}

}  // namespace

LeafCoverage::LeafCoverage(std::span<const Leaf> crown) {
    Box box;
    for (const Leaf& leaf : crown)
        for (vec3 corner : leaf.corners_plant) box.include(corner);
    center_ = box.center();
    const float across_m = std::sqrt(glm::dot(box.size(), box.size()));
    pixels_per_m_ = k_filled * float(k_side_px) / std::max(across_m, 1e-20f);
    full_ = count(crown);
}

CoverageExcess LeafCoverage::measure(std::span<const Leaf> leaves) const {
    const Pixels now = count(leaves);
    std::array<float, k_direction_count> excess{};
    CoverageExcess fit;
    for (size_t i = 0; i < k_direction_count; ++i) {
        // From where no pixel shows the full crown there is nothing to compare.
        if (full_[i] > 0) excess[i] = float(double(now[i]) / double(full_[i]) - 1.0);
        fit.mean += excess[i] / float(k_direction_count);
    }
    // The mean of (d^T E d) d d^T over all directions is 2 / 15 E.
    constexpr float k_fit = 7.5f / float(k_direction_count), k_third = 1.0f / 3.0f;
    for (size_t i = 0; i < k_direction_count; ++i) {
        const vec3 d = direction(i, k_direction_count), weighed = d * (k_fit * (excess[i] - fit.mean));
        const float third = k_fit * (excess[i] - fit.mean) * k_third;
        const float terms[6] = {weighed.x * d.x - third, weighed.y * d.y - third, weighed.z * d.z - third,
                                weighed.x * d.y,         weighed.x * d.z,         weighed.y * d.z};
        for (size_t k = 0; k < 6; ++k) fit.by_direction[k] += terms[k];
    }
    return fit;
}

LeafCoverage::Pixels LeafCoverage::count(std::span<const Leaf> leaves) const {
    Pixels pixels;
    parallel_for(k_direction_count, 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const vec3 d = direction(i, k_direction_count), x = perpendicular_to(d), y = glm::cross(d, x);
            CoverageRaster raster(k_side_px);
            raster.begin();
            for (const Leaf& leaf : leaves) {
                std::array<vec3, 4> p;
                for (size_t k = 0; k < 4; ++k) {
                    const vec3 away = (leaf.corners_plant[k] - center_) * pixels_per_m_;
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
