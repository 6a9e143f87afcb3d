#include "plugins/vegetation/cook/join_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include "plugins/vegetation/cook/measure_projection.h"

namespace coppice {
namespace {

// One primitive of a cell. The joined list takes them by rank: the j-th of a cell has (j + 1/2) / weight, so that a
// prefix holds of every cell a number in proportion to its weight.
struct Ranked {
    double rank;
    uint32_t cell, index;
};

std::vector<Ranked> rank_primitives(std::span<const uint32_t> counts, std::span<const double> weights) {
    std::vector<Ranked> ranked;
    for (uint32_t cell = 0; cell < counts.size(); ++cell)
        for (uint32_t i = 0; i < counts[cell]; ++i)
            ranked.push_back({(double(i) + 0.5) / weights[cell], cell, i});
    std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
        return a.rank != b.rank ? a.rank < b.rank : a.cell < b.cell;
    });
    return ranked;
}

vec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

void join_points(const PlantBlocks& packed, JoinedCells& joined) {
    std::vector<uint32_t> counts;
    std::vector<double> areas_m2;
    double area_m2 = 0.0, count = 0.0;
    for (const PackedPart& cell : packed.parts) {
        counts.push_back(cell.point_count);
        areas_m2.push_back(double(cell.area_m2));
        area_m2 += double(cell.area_m2);
        count += double(cell.point_count);
    }
    // No further than a cell's points reach, and one at least.
    double limit = double(k_joined_points_share) * count;
    for (size_t c = 0; c < counts.size(); ++c)
        limit = std::min(limit, double(counts[c]) * area_m2 / areas_m2[c]);
    for (size_t c = 0; c < counts.size(); ++c)
        counts[c] = std::min(counts[c], uint32_t(limit * areas_m2[c] / area_m2) + 1);
    std::vector<Ranked> ranked = rank_primitives(counts, areas_m2);
    ranked.resize(std::min(ranked.size(), std::max<size_t>(size_t(limit), 1)));
    for (const Ranked& r : ranked) {
        const PackedPart& cell = packed.parts[r.cell];
        joined.points.push_back(packed.points[cell.first_point + r.index]);
        joined.point_owners.push_back(cell.first_triangle + packed.point_owners[cell.first_point + r.index]);
    }
    joined.part.point_count = uint32_t(joined.points.size());
    joined.part.point_radius_m = float(std::sqrt(area_m2 / (double(joined.part.point_count) * double(k_pi))));
    // The same gain for the same points: the part's fill is that many times the cells'.
    const float fewer = float(double(joined.part.point_count) / count);
    for (uint32_t level = 0; level < k_gain_levels; ++level)
        joined.part.coverage_gain[level] =
            gain_at(packed.parts[0], portable_exp2(float(level) - float(k_gain_levels - 1)) * fewer);
}

void join_lines(const PlantBlocks& packed, JoinedCells& joined) {
    std::vector<uint32_t> counts;
    std::vector<double> weights;
    for (const PackedPart& cell : packed.parts) {
        counts.push_back(cell.line_count);
        weights.push_back(std::max(double(cell.line_count), 1.0));
    }
    const float width_m = joined.part.area_m2 / joined.part.line_length_m;
    std::vector<vec3> ends;
    for (const Ranked& r : rank_primitives(counts, weights)) {
        const PackedPart& cell = packed.parts[r.cell];
        const PackedVertex* line = &packed.line_vertices[2 * (size_t(cell.first_line) + r.index)];
        PackedVertex end = line[1];
        // Over the part's mean instead of the cell's.
        const float width = std::bit_cast<float>(end.surface) * (cell.area_m2 / cell.line_length_m) / width_m;
        end.surface = std::bit_cast<uint32_t>(std::clamp(width, 1.0e-6f, 100.0f));
        joined.line_vertices.push_back(line[0]);
        joined.line_vertices.push_back(end);
        ends.push_back(position_of(line[0]));
        ends.push_back(position_of(end));
    }
    joined.part.line_count = uint32_t(ends.size() / 2);
    joined.part.projected_length_m = fit_direction_form(projected_lengths_m(ends));
}

}  // namespace

JoinedCells join_cells(const PlantBlocks& packed, std::span<const CookPart> meshes) {
    JoinedCells joined;
    PackedPart& part = joined.part = packed.parts[0];
    part.first_triangle = part.first_point = part.first_line = 0;
    part.triangle_count = part.point_count = part.line_count = 0;
    double area_m2 = 0.0, line_length_m = 0.0;
    dvec3 color(0.0);
    Box bounds;
    std::array<double, k_projection_direction_count> seen_m2{};
    for (size_t c = 0; c < packed.parts.size(); ++c) {
        const PackedPart& cell = packed.parts[c];
        part.flags &= cell.flags;
        part.triangle_count += cell.triangle_count;
        part.line_error_m = std::max(part.line_error_m, cell.line_error_m);
        part.longest_edge_m = std::max(part.longest_edge_m, cell.longest_edge_m);
        area_m2 += meshes[c].area_m2;
        line_length_m += double(cell.line_length_m);
        color += dvec3(meshes[c].mean_color_linear) * meshes[c].area_m2;
        bounds.include(vec3(cell.bounds_min[0], cell.bounds_min[1], cell.bounds_min[2]));
        bounds.include(vec3(cell.bounds_max[0], cell.bounds_max[1], cell.bounds_max[2]));
        const auto of_cell = projected_areas_m2(meshes[c].shape.part, meshes[c].closed);
        for (size_t d = 0; d < seen_m2.size(); ++d) seen_m2[d] += of_cell[d];
    }
    part.area_m2 = float(area_m2);
    part.line_length_m = float(line_length_m);
    part.projected_area_m2 = fit_direction_form(seen_m2);
    for (int c = 0; c < 3; ++c) {
        part.mean_color_linear[c] = float(color[c] / area_m2);
        part.bounds_min[c] = bounds.min[c];
        part.bounds_max[c] = bounds.max[c];
    }
    if (part.kind == PackedPartKind::lines) {
        join_lines(packed, joined);
    } else {
        join_points(packed, joined);
    }
    return joined;
}

}  // namespace coppice
