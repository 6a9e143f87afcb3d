#include "plugins/vegetation/plant/line_points.h"

#include <algorithm>
#include <bit>

namespace coppice {
namespace {

constexpr uint32_t k_least_points = 64;  // a trunk may be one line

// 1/2, 1/4, 3/4, 1/8 ...
float place_of_round(uint32_t round) {
    uint32_t reversed = 0;
    for (uint32_t digits = round + 1, bit = 1u << 31; digits != 0; digits >>= 1, bit >>= 1)
        if (digits & 1u) reversed |= bit;
    return float(reversed >> 8) * 0x1p-24f;
}

}  // namespace

uint32_t line_point_count(const PackedPart& part) {
    if (part.line_count == 0) return 0;
    return (std::max(part.line_count, k_least_points) + part.line_count - 1) / part.line_count *
           part.line_count;
}

LinePoint line_point(const PackedPart& part, std::span<const PackedVertex> line_vertices, uint32_t i) {
    const PackedVertex* ends = &line_vertices[2 * (size_t(part.first_line) + i % part.line_count)];
    const vec3 begin(ends[0].x_plant, ends[0].y_plant, ends[0].z_plant);
    const vec3 end(ends[1].x_plant, ends[1].y_plant, ends[1].z_plant);
    const vec3 at = begin + (end - begin) * place_of_round(i / part.line_count);
    uint32_t surface = ends[0].surface;
    // A line has one normal, but of all sides of a stem some must face the viewer, also where it is one line.
    if (i >= part.line_count && !(surface & k_leaf_bit)) {
        const vec3 along = normalize_or(end - begin, vec3(0, 1, 0));
        const float around = float((i * 2654435769u) >> 8) * 0x1p-24f * 2.0f * k_pi;
        surface = replace_normal(surface, rotate_about(perpendicular_to(along), along, around));
    }
    return {{at.x, at.y, at.z, surface}, std::bit_cast<float>(ends[1].surface)};
}

float pack_density(double density, float area_share) {
    constexpr uint32_t k_steps = 1u << k_side_bits;
    const float share = std::clamp(area_share, k_least_area_share, k_largest_area_share);
    const uint32_t side = uint32_t(portable_log2(share) * 16.0f + 128.5f);
    // To the nearest float that ends so.
    const uint32_t bits = std::max(std::bit_cast<uint32_t>(float(density)), side) - side;
    return std::bit_cast<float>(((bits + k_steps / 2) & ~(k_steps - 1)) + side);
}

}  // namespace coppice
