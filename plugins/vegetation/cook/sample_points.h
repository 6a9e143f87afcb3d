// Points that stand for a part's triangles in the distance. Source: Deussen et al. 2002, section 4.1.
// Deviates: positions are stratified along an area-preserving space-filling curve over the surface (a Hilbert
// curve through the triangles, continued by bisection inside them) instead of drawn independently.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/cook/progressive_order.h"
#include "plugins/vegetation/plant/description.h"

namespace coppice {

enum class PointSampler : uint8_t {
    automatic,  // two_per_triangle where the triangles' areas vary by less than a quarter of their mean
    area,       // equal area, equal number of points
    two_per_triangle,  // the paper's for parts of nearly equal triangles; the number of points is then 2 n
};

struct SampleSettings {
    PointSampler sampler = PointSampler::automatic;
    PrefixOrder order = PrefixOrder::progressive;
    float points_per_triangle = 2.0f;  // of the sampler `area`; (0, 64]
    uint64_t seed = 0;
};

struct SampledPoint {
    uint32_t triangle;  // index in the part
    float share[3];     // barycentric coordinates: weights of the triangle's corners
};

struct SampledPoints {
    PointSampler sampler;              // which was used
    std::vector<SampledPoint> points;  // every prefix is spread over the surface in proportion to area
};

// curve: the part's triangles along a space-filling curve (order_along_curve of their centres).
// With two_per_triangle and `shuffled`, points 2 i and 2 i + 1 belong to triangle triangle_order[i], as in
// the paper; with `progressive` the first half of the points meets every triangle once, in that order, then
// the second half. Requires a clean mesh and count_points below 2^32. Parallel; the same on any number of
// threads.
SampledPoints sample_points(const PartDescription& part, std::span<const uint32_t> curve,
                            std::span<const uint32_t> triangle_order, const SampleSettings& settings);

// How many points sample_points makes.
uint64_t count_points(const PartDescription& part, const SampleSettings& settings);

// Standard deviation of the triangles' areas over their mean.
float area_variation(const PartDescription& part);

}  // namespace coppice
