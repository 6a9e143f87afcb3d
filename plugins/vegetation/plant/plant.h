// A packed plant in memory: a view into one mapped .plant file (or into a buffer of the same bytes), used in
// place. Format, little-endian: header, parts, then one block each of triangle vertices, points, point
// owners, line vertices, cells, crowns and their leaves; every block is checksummed (XXH3-64) and starts at a multiple of 64 bytes.
// pack.cpp writes, load.cpp reads.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/mapped_file.h"
#include "runtime/core/math.h"

namespace coppice {

// 16 bytes, what the kernels fetch in one load.
struct PackedVertex {
    float x_plant, y_plant, z_plant;  // m
    uint32_t surface;                 // surface.h; the normal in plant space
};
static_assert(sizeof(PackedVertex) == 16);

// v(d) = sqrt(d^T M d) for a unit direction d in plant space, M symmetric: xx yy zz xy xz yz. A fit over
// directions of the projected area (m2) or length (m). The root makes it exact for a flat part, a cylinder, a
// straight line and an isotropic cloud, where a plain quadratic form is off by 5 % of the mean (stems) and 12
// % face on (a flat part). Use evaluate(): never negative, never NaN.
struct DirectionForm {
    std::array<float, 6> m{};
    float evaluate(vec3 d) const {
        const float square = m[0] * d.x * d.x + m[1] * d.y * d.y + m[2] * d.z * d.z +
                             2.0f * (m[3] * d.x * d.y + m[4] * d.x * d.z + m[5] * d.y * d.z);
        return square > 0.0f ? std::sqrt(square) : 0.0f;
    }
};

inline constexpr uint32_t k_part_closed = 1;  // of a closed surface only the front half can be seen
inline constexpr uint32_t k_part_leaf = 2;    // lit from both sides
inline constexpr uint32_t k_part_faces_outwards =
    4;  // closed, and wound so that back faces need not be drawn
inline constexpr uint32_t k_part_prefers_leaves = 8;  // its crown's leaves are drawn wherever there are some

enum class PackedPartKind : uint32_t { points = 0, lines = 1 };

// Coverage gains at log2(fill) = -(k_gain_levels - 1) ... 0, where fill is the projected area in square
// pixels over the number of points, or over the projected length of the lines in pixels: how finely the part
// is resolved at d' = 1.
inline constexpr uint32_t k_gain_levels = 16;

// How points and lines are sized by the height that the plant is looked at from: from above other shares of it are hidden
// than from the side. A size goes with 1 + second P_2 + fourth P_4, Legendre's polynomials of the height's sine, so that the
// mean over all directions stays; and of plants that are turned about the vertical in all ways and lean by an angle whose
// cosine is c, each is P(c) times as much.
struct HeightGain {
    float second = 0.0f, fourth = 0.0f;
};
inline float legendre_2(float x) { return 1.5f * x * x - 0.5f; }
inline float legendre_4(float x) { return (4.375f * x * x - 3.75f) * x * x + 0.375f; }
// As stored, in steps of 1 / k_height_steps.
struct HeightSteps {
    int8_t second, fourth;
};
inline constexpr float k_height_steps = 60.0f;
inline HeightSteps round_height_gain(HeightGain gain) {
    auto round = [](float value) {
        const float steps = std::floor(value * k_height_steps + 0.5f);
        return int8_t(steps < -127.0f ? -127.0f : steps < 127.0f ? steps : 127.0f);
    };
    return {round(gain.second), round(gain.fourth)};
}
inline HeightGain height_gain_of(HeightSteps steps) {
    return {float(steps.second) / k_height_steps, float(steps.fourth) / k_height_steps};
}
inline constexpr uint32_t k_height_gain_levels = k_gain_levels / 2;

// One part, or one octree cell's share of a part. 256 bytes.
struct PackedPart {
    char name[32];                            // UTF-8, zero-terminated
    PackedPartKind kind;                      // what stands for its triangles in the distance
    uint32_t flags;                           // k_part_*
    float importance;                         // > 0, multiplies the primitive counts
    uint32_t first_triangle, triangle_count;  // k; in progressive order: every prefix is well spread
    uint32_t first_point, point_count;        // n_p; progressive; 0 where kind is lines
    uint32_t first_line, line_count;          // n_l; progressive; 0 where kind is points
    float area_m2;                            // A: sum of the triangles' areas, each side counted once
    float line_length_m;                      // l
    float line_error_m;                       // eps_l: largest distance from the surface to the lines
    float longest_edge_m;                     // of any triangle: bounds its size on screen
    float point_radius_m;                     // sqrt(A / n_p / pi): the surface one point stands for
    float bounds_min[3], bounds_max[3];
    DirectionForm projected_area_m2;   // of what faces the viewer: half of a closed surface
    DirectionForm projected_length_m;  // of the lines
    float mean_color_linear[3];
    std::array<float, k_gain_levels> coverage_gain;  // cook/measure_coverage.h
    uint32_t part;                                   // of a cell: index of the part it is cut from; else 0
    std::array<HeightSteps, k_height_gain_levels> height_gain;  // of every second level
};
static_assert(sizeof(PackedPart) == 256);

// Of level k_gain_levels - 1 it is 1. The levels of height_gain are 1, 3, 5 ...
inline float fill_at_level(uint32_t level) { return 1.0f / float(1u << (k_gain_levels - 1 - level)); }
// Between which levels a fill > 0 lies, by piecewise linear logarithm.
struct GainPlace {
    int32_t level;  // not the last one
    float share;    // of the next level
};
inline GainPlace place_among(float fill, uint32_t count, float levels_an_octave) {
    // Exponent and mantissa read as one number: the logarithm, with straight lines between powers of two.
    const float last = float(count - 1);
    const float logarithm =
        float(std::bit_cast<int32_t>(fill > 1.0e-30f ? fill : 1.0e-30f)) * 0x1p-23f - 127.0f;
    const float from_first = logarithm * levels_an_octave + last;
    const float above_first = from_first > 0.0f ? from_first : 0.0f;
    const float place = above_first < last ? above_first : last;
    const int32_t level = int32_t(place < last - 1.0f ? place : last - 1.0f);
    return {level, place - float(level)};
}
inline GainPlace gain_place(float fill) { return place_among(fill, k_gain_levels, 1.0f); }
inline GainPlace height_gain_place(float fill) { return place_among(fill, k_height_gain_levels, 0.5f); }
// The coverage gain, in [1/16, 4] of a checked part.
inline float gain_at(const std::array<float, k_gain_levels>& gains, GainPlace place) {
    return gains[size_t(place.level)] * (1.0f - place.share) + gains[size_t(place.level) + 1] * place.share;
}
inline float gain_at(const PackedPart& part, float fill) {
    return gain_at(part.coverage_gain, gain_place(fill));
}
inline HeightGain height_gain_at(const std::array<HeightGain, k_height_gain_levels>& gains, GainPlace place) {
    const HeightGain &low = gains[size_t(place.level)], &high = gains[size_t(place.level) + 1];
    return {low.second * (1.0f - place.share) + high.second * place.share,
            low.fourth * (1.0f - place.share) + high.fourth * place.share};
}
inline HeightGain height_gain_at(const PackedPart& part, float fill) {
    const GainPlace place = height_gain_place(fill);
    std::array<HeightGain, k_height_gain_levels> gains{};
    for (size_t level : {size_t(place.level), size_t(place.level) + 1})
        gains[level] = height_gain_of(part.height_gain[level]);
    return height_gain_at(gains, place);
}
// How many times as large points and lines are drawn where the plant is looked at from that height, in [-1, 1].
// draw/raster.glsl has it as well.
inline constexpr float k_least_seen_gain = 0.1f, k_largest_seen_gain = 1.6f;
inline float seen_gain(HeightGain gain, float height) {
    const float seen = 1.0f + gain.second * legendre_2(height) + gain.fourth * legendre_4(height);
    return seen < k_least_seen_gain     ? k_least_seen_gain
           : seen < k_largest_seen_gain ? seen
                                        : k_largest_seen_gain;
}

// What is seen of the part in the mean over all directions, whatever its shape: half its surface, of which a closed one
// shows half. Of its points, which share that surface out, each shows |n . v| of its share.
inline float mean_projected_area_m2(const PackedPart& part) {
    return part.area_m2 * (part.flags & k_part_closed ? 0.25f : 0.5f);
}

// Of the lines' length likewise: a line of random direction shows pi / 4 of its own (ERRATA 2).
inline float mean_projected_length_m(const PackedPart& part) { return 0.25f * k_pi * part.line_length_m; }

// A leaf of a crown at some of its levels of detail (leaf_bands.h): triangles (0, 1, 2) and (0, 2, 3) of four corners. 32
// bytes, two fetches of a kernel.
struct PackedLeaf {
    std::array<uint16_t, 12> corners;  // x y z each, in steps of the part's LeafGrid
    uint32_t surface;                  // surface.h; the normal that both triangles are lit by, in plant space
    uint32_t birth_level;              // from which on it is there
};
static_assert(sizeof(PackedLeaf) == 32);

// The leaves of one part, by bands. At level c of full_count - least_count at most, full_count - c are drawn.
struct PackedCrown {
    uint32_t part;
    uint32_t first_leaf;  // banded_leaf_count of them
    uint32_t full_count, least_count;
};

// Where a part's leaves have their corners: within its bounds, to 1 / 65535 of these.
struct LeafGrid {
    vec3 origin_plant, step_m;  // steps > 0
};
inline LeafGrid leaf_grid(const PackedPart& part) {
    LeafGrid grid;
    for (int axis = 0; axis < 3; ++axis) {
        const float size_m = part.bounds_max[axis] - part.bounds_min[axis];
        grid.origin_plant[axis] = part.bounds_min[axis];
        grid.step_m[axis] = (size_m > 1.0e-6f ? size_m : 1.0e-6f) / 65535.0f;
    }
    return grid;
}

struct Plant {
    std::string name;
    Box bounds_plant;
    uint64_t content_hash = 0;  // of the whole file: of its head, which holds the checksums of the rest
    std::span<const PackedPart> parts;
    std::span<const PackedVertex> triangle_vertices;  // three a triangle
    std::span<const PackedVertex> points;
    std::span<const uint32_t>
        point_owners;  // for each point, its triangle's index within the part: the blend draws
                       // triangles [0, t) and the points whose owner is >= t
    std::span<const PackedVertex>
        line_vertices;  // two a line; the second one's surface is not a surface but the
                        // line's own width over the part's mean, as float bits, in (0, 100]
    // Octree cells of large parts, part after part: what a viewer near the plant draws in place of the part.
    // They share its triangles out; their points and lines are a choice of the part's before it was cut, in
    // its order, and stand behind all parts'. Such a part itself keeps the points that far views need, and of
    // its triangles, which are sorted by cell, only all can be drawn.
    std::span<const PackedPart> cells;
    std::span<const PackedCrown> crowns;  // by part, at most one each: of parts with leaves enough
    std::span<const PackedLeaf> leaves;   // crown after crown
    uint32_t dropped_triangles = 0;          // zero area or not finite, left out by the cook
    uint32_t dropped_vertices = 0;           // used by no triangle
    std::shared_ptr<const MappedFile> file;  // keeps the spans alive; or:
    std::shared_ptr<const std::vector<std::byte>> memory;
};

// Everything is checked before it is used: magic, version, block bounds (overflow-safe), checksums, that all
// ranges of parts and cells follow each other through their blocks without gaps, that cells share their parts
// out, that all positions are finite and within k_position_limit_m (description.h). Errors: file_*,
// format_unknown, value_out_of_range.
Result<Plant> load_plant(const std::string& path);
Result<Plant> load_plant_from_memory(std::shared_ptr<const std::vector<std::byte>> bytes,
                                     const std::string& name);

}  // namespace coppice
