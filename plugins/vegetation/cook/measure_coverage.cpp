#include "plugins/vegetation/cook/measure_coverage.h"

#include <algorithm>
#include <bit>
#include <vector>
#include "plugins/vegetation/cook/coverage_raster.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr uint32_t k_side_limit = 2048;
constexpr double k_wanted_pixels = 30000.0;  // over all views of a level: keeps its noise under 1 %
constexpr double k_triangle_budget = 3.0e6;  // over all views of a level
constexpr uint32_t k_least_views = 8, k_most_views = 8192;
// Below these a level says what the next larger one says.
constexpr float k_least_area_px2 = 0.5f;
constexpr double k_least_pixels = 2000.0;  // over all views: noise under 3 %
constexpr int k_rounds = 6;
constexpr float k_settled = 0.001f;  // octaves

struct View {
    vec3 right, up;
    vec2 shift;
    float chance;
};

// Directions well spread over the upper hemisphere, the zenith left out.
View view_of(uint32_t index, uint32_t count) {
    float height = 0.95f * (float(index) + 0.5f) / float(count);
    float around = 2.0f * k_pi * 0.61803399f * float(index), level = std::sqrt(1.0f - height * height);
    vec3 direction(-level * portable_cos(around), -height, -level * portable_sin(around));
    View view;
    view.right = perpendicular_to(direction);
    view.up = glm::cross(view.right, direction);
    Random random(17, index);
    view.shift.x = random.next_unit();  // one after the other: arguments of a call have no order
    view.shift.y = random.next_unit();
    view.chance = random.next_unit();
    return view;
}

class PartCoverage {
  public:
    PartCoverage(const PackedPart& part, std::span<const PackedVertex> triangle_vertices,
                 std::span<const PackedVertex> points, std::span<const PackedVertex> line_vertices)
        : part_(part), triangle_vertices_(triangle_vertices), points_(points), line_vertices_(line_vertices) {
        for (const PackedVertex& v : triangle_vertices)
            bounds_.include(vec3(v.x_plant, v.y_plant, v.z_plant));
        for (const PackedVertex& v : line_vertices) bounds_.include(vec3(v.x_plant, v.y_plant, v.z_plant));
    }

    // The gain at a mean pixel size, or 0 where it cannot be measured.
    float measure(float pixels_per_meter, float area_px2) const {
        float radius_px = 0.5f * glm::length(bounds_.size()) * pixels_per_meter;
        uint32_t side = uint32_t(std::min(2.0f * radius_px + 6.0f, float(k_side_limit) + 1.0f));
        if (area_px2 < k_least_area_px2 || side > k_side_limit) return 0.0f;
        double by_cost = k_triangle_budget / double(part_.triangle_count + 1);
        uint32_t views = uint32_t(std::clamp(std::min(k_wanted_pixels / double(area_px2), by_cost),
                                             double(k_least_views), double(k_most_views)));
        if (double(views) * double(area_px2) < k_least_pixels) return 0.0f;
        CoverageRaster raster(side);
        uint64_t wanted = 0;
        for (uint32_t i = 0; i < views; ++i)
            wanted += full(raster, view_of(i, views), pixels_per_meter, side);
        if (wanted == 0) return 0.0f;
        // Coverage grows by a power of the area drawn that falls where points lie on each other: secants in logarithms.
        float gain = 1.0f, power = 1.0f, last_gain = 0.0f, last_drawn = 0.0f;
        for (int round = 0; round < k_rounds; ++round) {
            uint64_t pixels = 0;
            for (uint32_t i = 0; i < views; ++i)
                pixels += reduced(raster, view_of(i, views), pixels_per_meter, side, gain);
            if (pixels == 0) return 0.0f;
            const float drawn = portable_log2(float(pixels)), missing = portable_log2(float(wanted)) - drawn;
            if (std::fabs(missing) < k_settled) break;
            const float log_gain = portable_log2(gain);
            if (round > 0 && log_gain != last_gain)
                power = std::clamp((drawn - last_drawn) / (log_gain - last_gain), 0.25f, 1.0f);
            last_gain = log_gain;
            last_drawn = drawn;
            gain = std::clamp(gain * portable_exp2(missing / power), 0.25f, 4.0f);
        }
        return gain;
    }

  private:
    vec2 place(const View& view, const PackedVertex& v, float pixels_per_meter, uint32_t side) const {
        vec3 p = (vec3(v.x_plant, v.y_plant, v.z_plant) - bounds_.center()) * pixels_per_meter;
        return vec2(glm::dot(view.right, p), glm::dot(view.up, p)) + view.shift + 0.5f * float(side);
    }
    uint64_t full(CoverageRaster& raster, const View& view, float pixels_per_meter, uint32_t side) const {
        raster.begin();
        for (size_t i = 0; i + 2 < triangle_vertices_.size(); i += 3)
            raster.triangle(place(view, triangle_vertices_[i], pixels_per_meter, side),
                            place(view, triangle_vertices_[i + 1], pixels_per_meter, side),
                            place(view, triangle_vertices_[i + 2], pixels_per_meter, side));
        return raster.covered();
    }
    // What lod/choose_part.cpp would draw at a sample distance of one pixel, were there no triangles.
    uint64_t reduced(CoverageRaster& raster, const View& view, float pixels_per_meter, uint32_t side,
                     float gain) const {
        vec3 direction = glm::cross(view.up, view.right);
        const float square = pixels_per_meter * pixels_per_meter;
        raster.begin();
        if (!points_.empty()) {
            // lod/choose_part.cpp: the mean over all directions asks for points; |n . v|, a half in the mean, sizes them.
            const float area = gain * mean_projected_area_m2(part_) * square;
            float stored = float(points_.size()), p = std::min(part_.importance * area, stored);
            float splat_area = 2.0f * area / std::max(p, 1.0e-6f);
            size_t count = std::min(points_.size(), size_t(p + view.chance));
            for (size_t i = 0; i < count; ++i)
                raster.square(place(view, points_[i], pixels_per_meter, side),
                              std::sqrt(splat_area * facing_of(points_[i], direction)));
        } else {
            const float area = gain * part_.projected_area_m2.evaluate(direction) * square;
            float length = part_.projected_length_m.evaluate(direction) * pixels_per_meter;
            float q = std::min(part_.importance * area / std::max(length, 1.0e-6f), 1.0f),
                  stored = float(line_vertices_.size() / 2);
            size_t count = std::min(line_vertices_.size() / 2, size_t(q * stored + view.chance));
            float width = area / std::max(length * q, 1.0e-6f);
            for (size_t i = 0; i < count; ++i)
                raster.line(place(view, line_vertices_[2 * i], pixels_per_meter, side),
                            place(view, line_vertices_[2 * i + 1], pixels_per_meter, side),
                            width * std::bit_cast<float>(line_vertices_[2 * i + 1].surface));
        }
        return raster.covered();
    }

    static float facing_of(const PackedVertex& vertex, vec3 direction) {
        return std::fabs(glm::dot(decode_surface(vertex.surface).normal, direction));
    }

    const PackedPart& part_;
    std::span<const PackedVertex> triangle_vertices_, points_, line_vertices_;
    Box bounds_;
};

float mean_over_views(const DirectionForm& form) {
    float sum = 0.0f;
    for (uint32_t i = 0; i < 64; ++i) {
        View view = view_of(i, 64);
        sum += form.evaluate(glm::cross(view.up, view.right));
    }
    return sum / 64.0f;
}

}  // namespace

std::array<float, k_gain_levels> measure_coverage_gain(const PackedPart& part,
                                                       std::span<const PackedVertex> triangle_vertices,
                                                       std::span<const PackedVertex> points,
                                                       std::span<const PackedVertex> line_vertices) {
    std::array<float, k_gain_levels> gains;
    gains.fill(1.0f);
    // By which gain_at is asked.
    float area_m2 = points.empty() ? mean_over_views(part.projected_area_m2) : mean_projected_area_m2(part),
          length_m = mean_over_views(part.projected_length_m);
    if (!(area_m2 > 0.0f) || (points.empty() && !(line_vertices.size() > 1 && length_m > 0.0f))) return gains;
    PartCoverage coverage(part, triangle_vertices, points, line_vertices);
    std::array<float, k_gain_levels> measured{};
    parallel_for(k_gain_levels, 1, [&](size_t first, size_t last) {
        for (size_t level = first; level < last; ++level) {
            float fill = portable_exp2(float(level) - float(k_gain_levels - 1));
            // fill = area_px2 / n_p for points, area_px2 / length_px for lines (gain_at)
            float pixels_per_meter =
                points.empty() ? fill * length_m / area_m2 : std::sqrt(fill * float(points.size()) / area_m2);
            measured[level] =
                coverage.measure(pixels_per_meter, area_m2 * pixels_per_meter * pixels_per_meter);
        }
    });
    // What could not be measured takes its neighbour's: small sizes from the next larger, large from the next
    // smaller.
    for (size_t level = k_gain_levels; level-- > 0;)
        gains[level] = measured[level] > 0.0f      ? measured[level]
                       : level + 1 < k_gain_levels ? gains[level + 1]
                                                   : 0.0f;
    for (size_t level = 0; level < k_gain_levels; ++level)
        if (!(gains[level] > 0.0f)) gains[level] = level > 0 ? gains[level - 1] : 1.0f;
    return gains;
}

}  // namespace coppice
