#include "plugins/vegetation/cook/sample_points.h"

#include <algorithm>
#include "plugins/vegetation/cook/triangle_areas.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr size_t k_grain = 1 << 13;
constexpr float k_equal_areas = 0.25f;

// A place in the triangle for u in [0, 1): halves of the unit interval go to halves of the triangle, across
// the middle of its longest edge, `depth` times; what is left of the interval is one small triangle, in which
// two random numbers choose.
SampledPoint place_in_triangle(uint32_t triangle, const vec3 corner[3], double u, int depth, Random random) {
    float share[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    vec3 at[3] = {corner[0], corner[1], corner[2]};
    for (int step = 0; step < depth; ++step) {
        int apex = 0;  // opposite the longest edge
        float longest = -1.0f;
        for (int k = 0; k < 3; ++k) {
            vec3 edge = at[(k + 2) % 3] - at[(k + 1) % 3];
            float square = glm::dot(edge, edge);
            if (square > longest) {
                longest = square;
                apex = k;
            }
        }
        u *= 2.0;
        int replaced = u < 1.0 ? (apex + 2) % 3 : (apex + 1) % 3,
            kept = u < 1.0 ? (apex + 1) % 3 : (apex + 2) % 3;
        if (u >= 1.0) u -= 1.0;
        at[replaced] = (at[replaced] + at[kept]) * 0.5f;
        for (int c = 0; c < 3; ++c) share[replaced][c] = (share[replaced][c] + share[kept][c]) * 0.5f;
    }
    float a = random.next_unit(), b = random.next_unit();
    if (a + b > 1.0f) {
        a = 1.0f - a;
        b = 1.0f - b;
    }
    SampledPoint point{triangle, {}};
    for (int c = 0; c < 3; ++c)
        point.share[c] = share[0][c] + a * (share[1][c] - share[0][c]) + b * (share[2][c] - share[0][c]);
    return point;
}

void corners_of(const PartDescription& part, uint32_t triangle, vec3 corner[3]) {
    for (int k = 0; k < 3; ++k)
        corner[k] = part.vertices[part.indices[3 * size_t(triangle) + size_t(k)]].position_plant;
}

std::vector<SampledPoint> sample_area(const PartDescription& part, std::span<const uint32_t> curve,
                                      const SampleSettings& settings, uint32_t point_count) {
    std::vector<double> areas = triangle_areas(part);
    std::vector<double> area_before(curve.size() + 1, 0.0);  // along the curve
    for (size_t i = 0; i < curve.size(); ++i) area_before[i + 1] = area_before[i] + areas[curve[i]];
    double point_area = area_before.back() / point_count;

    std::vector<SampledPoint> along(point_count);
    parallel_for(point_count, k_grain, [&](size_t first, size_t last) {
        size_t at =
            size_t(std::upper_bound(area_before.begin(), area_before.end(), point_area * double(first)) -
                   area_before.begin());
        at = at > 0 ? at - 1 : 0;
        for (size_t i = first; i < last; ++i) {
            Random random(settings.seed, i);
            double position = point_area * (double(i) + double(random.next_unit()));
            while (at + 1 < curve.size() && area_before[at + 1] <= position) ++at;
            double area = areas[curve[at]];
            double u = std::clamp((position - area_before[at]) / area, 0.0, 1.0 - 1e-9);
            int depth = 0;
            for (double piece = area; piece > 0.75 * point_area && depth < 40; piece *= 0.5) ++depth;
            vec3 corner[3];
            corners_of(part, curve[at], corner);
            along[i] = place_in_triangle(curve[at], corner, u, depth, random);
        }
    });
    std::vector<uint32_t> order =
        make_prefix_order(point_count, settings.order, hash_combine(settings.seed, 1));
    std::vector<SampledPoint> points(point_count);
    parallel_for(point_count, k_grain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) points[i] = along[order[i]];
    });
    return points;
}

std::vector<SampledPoint> sample_two_per_triangle(const PartDescription& part,
                                                  std::span<const uint32_t> triangle_order,
                                                  const SampleSettings& settings) {
    size_t triangle_count = triangle_order.size();
    std::vector<SampledPoint> points(2 * triangle_count);
    bool paired = settings.order == PrefixOrder::shuffled;
    parallel_for(triangle_count, k_grain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            uint32_t triangle = triangle_order[i];
            Random random(settings.seed, triangle);
            vec3 corner[3];
            corners_of(part, triangle, corner);
            // One in each half, and which comes first by a coin.
            double half = random.next_unit() < 0.5f ? 0.0 : 0.5;
            for (size_t k = 0; k < 2; ++k) {
                size_t place = paired ? 2 * i + k : k * triangle_count + i;
                points[place] =
                    place_in_triangle(triangle, corner, k == 0 ? half : 0.5 - half, 1, random.fork(k));
            }
        }
    });
    return points;
}

PointSampler choose_sampler(const PartDescription& part, PointSampler wanted) {
    if (wanted != PointSampler::automatic) return wanted;
    return area_variation(part) < k_equal_areas ? PointSampler::two_per_triangle : PointSampler::area;
}

}  // namespace

float area_variation(const PartDescription& part) {
    std::vector<double> areas = triangle_areas(part);
    double mean = 0.0, square = 0.0;
    for (double area : areas) mean += area;
    mean /= double(std::max<size_t>(areas.size(), 1));
    for (double area : areas) square += (area - mean) * (area - mean);
    return mean > 0.0 ? float(std::sqrt(square / double(areas.size())) / mean) : 0.0f;
}

uint64_t count_points(const PartDescription& part, const SampleSettings& settings) {
    uint64_t triangle_count = part.indices.size() / 3;
    if (choose_sampler(part, settings.sampler) == PointSampler::two_per_triangle) return 2 * triangle_count;
    return uint64_t(
        std::ceil(double(triangle_count) * double(std::clamp(settings.points_per_triangle, 1e-3f, 64.0f))));
}

SampledPoints sample_points(const PartDescription& part, std::span<const uint32_t> curve,
                            std::span<const uint32_t> triangle_order, const SampleSettings& settings) {
    SampledPoints sampled;
    SampleSettings chosen = settings;
    chosen.sampler = sampled.sampler = choose_sampler(part, settings.sampler);
    if (curve.empty()) return sampled;
    if (chosen.sampler == PointSampler::two_per_triangle) {
        sampled.points = sample_two_per_triangle(part, triangle_order, chosen);
    } else {
        sampled.points = sample_area(part, curve, chosen, uint32_t(count_points(part, chosen)));
    }
    return sampled;
}

}  // namespace coppice
