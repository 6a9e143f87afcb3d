#include "plugins/vegetation/cook/cut_part.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tuple>
#include "plugins/vegetation/cook/measure_projection.h"
#include "plugins/vegetation/cook/triangle_areas.h"

namespace coppice {
namespace {

vec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

PartDescription mesh_of(std::span<const PackedVertex> triangle_vertices) {
    PartDescription mesh;
    for (const PackedVertex& v : triangle_vertices) {
        const Surface surface = decode_surface(v.surface);
        mesh.indices.push_back(uint32_t(mesh.vertices.size()));
        mesh.vertices.push_back({position_of(v), surface.normal, surface.color_linear});
    }
    return mesh;
}

// The triangles one cell behind the other. Returns for each where it has gone.
std::vector<uint32_t> sort_triangles(PlantBlocks& packed, std::span<const uint32_t> cell_of_triangle,
                                     std::span<PackedPart> cells) {
    for (uint32_t cell : cell_of_triangle) ++cells[cell].triangle_count;
    uint32_t first = 0;
    for (PackedPart& cell : cells) {
        cell.first_triangle = first;
        first += cell.triangle_count;
        cell.triangle_count = 0;
    }
    std::vector<uint32_t> place_of(cell_of_triangle.size());
    std::vector<PackedVertex> sorted(packed.triangle_vertices.size());
    for (size_t t = 0; t < place_of.size(); ++t) {
        PackedPart& cell = cells[cell_of_triangle[t]];
        place_of[t] = cell.first_triangle + cell.triangle_count++;
        for (size_t k = 0; k < 3; ++k)
            sorted[3 * size_t(place_of[t]) + k] = packed.triangle_vertices[3 * t + k];
    }
    packed.triangle_vertices = std::move(sorted);
    return place_of;
}

// Requires the cell's triangles and lines in their places.
void measure_cell(PackedPart& cell, std::span<const PackedVertex> triangle_vertices,
                  std::span<PackedVertex> line_vertices, float part_width_m) {
    const PartDescription mesh = mesh_of(triangle_vertices);
    const auto [area_m2, color] = measure_area_and_color(mesh);
    cell.area_m2 = float(area_m2);
    cell.projected_area_m2 = fit_direction_form(projected_areas_m2(mesh, (cell.flags & k_part_closed) != 0));
    Box bounds;
    float longest_square = 0.0f;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
        const vec3 here = mesh.vertices[i].position_plant;
        const vec3 edge = mesh.vertices[i % 3 == 2 ? i - 2 : i + 1].position_plant - here;
        longest_square = std::max(longest_square, glm::dot(edge, edge));
        bounds.include(here);
    }
    cell.longest_edge_m = std::sqrt(longest_square);
    std::vector<vec3> ends;
    double length_m = 0.0;
    for (const PackedVertex& v : line_vertices) {
        ends.push_back(position_of(v));
        bounds.include(ends.back());
        if (ends.size() % 2 == 0) length_m += double(glm::length(ends.back() - ends[ends.size() - 2]));
    }
    cell.line_length_m = float(length_m);
    cell.projected_length_m = fit_direction_form(projected_lengths_m(ends));
    for (int c = 0; c < 3; ++c) {
        cell.mean_color_linear[c] = color[c];
        cell.bounds_min[c] = bounds.min[c];
        cell.bounds_max[c] = bounds.max[c];
    }
    if (cell.point_count > 0)
        cell.point_radius_m = float(std::sqrt(area_m2 / (double(cell.point_count) * double(k_pi))));
    // Widths are over the cell's mean instead of the part's.
    for (size_t i = 1; i < line_vertices.size(); i += 2) {
        const float width = std::bit_cast<float>(line_vertices[i].surface) * part_width_m *
                            (cell.line_length_m / cell.area_m2);
        line_vertices[i].surface = std::bit_cast<uint32_t>(std::clamp(width, 1.0e-6f, 100.0f));
    }
}

void keep_far_points(PlantBlocks& packed) {
    PackedPart& part = packed.parts[0];
    if (part.point_count == 0) return;
    const uint32_t kept = std::max(uint32_t(k_kept_points_share * float(part.point_count)), 1u);
    // The same gain for the same points: the part's fill is that many times what it was.
    const float share = float(kept) / float(part.point_count);
    const PackedPart before = part;
    for (uint32_t level = 0; level < k_gain_levels; ++level)
        part.coverage_gain[level] = gain_at(before, fill_at_level(level) * share);
    for (uint32_t level = 0; level < part.height_gain.size(); ++level)
        part.height_gain[level] =
            round_height_gain(height_gain_at(before, fill_at_level(2 * level + 1) * share));
    part.point_count = kept;
    part.point_radius_m = float(std::sqrt(double(part.area_m2) / (double(kept) * double(k_pi))));
    packed.points.resize(kept);
    packed.point_owners.resize(kept);
}

}  // namespace

OctreeUnits list_units(const PlantBlocks& packed, std::span<const uint32_t> line_of_triangle) {
    OctreeUnits units;
    const size_t triangle_count = packed.triangle_vertices.size() / 3;
    if (line_of_triangle.empty()) {
        units.triangle_count.assign(triangle_count, 1);
        for (size_t t = 0; t < triangle_count; ++t) {
            const PackedVertex* v = &packed.triangle_vertices[3 * t];
            units.middle_plant.push_back((position_of(v[0]) + position_of(v[1]) + position_of(v[2])) *
                                         (1.0f / 3.0f));
        }
        return units;
    }
    for (size_t v = 0; v < packed.line_vertices.size(); v += 2)
        units.middle_plant.push_back(
            (position_of(packed.line_vertices[v]) + position_of(packed.line_vertices[v + 1])) * 0.5f);
    units.triangle_count.assign(units.middle_plant.size(), 0);
    for (uint32_t line : line_of_triangle) ++units.triangle_count[line];
    return units;
}

PlantBlocks cut_part(PlantBlocks& packed, std::span<const uint32_t> cell_of_unit,
                     std::span<const uint32_t> line_of_triangle) {
    assert(packed.parts.size() == 1 && !cell_of_unit.empty());
    const PackedPart& part = packed.parts[0];
    PlantBlocks result;
    PackedPart like = part;
    like.triangle_count = like.point_count = like.line_count = 0;
    result.cells.assign(*std::max_element(cell_of_unit.begin(), cell_of_unit.end()) + 1, like);

    std::vector<uint32_t> cell_of_triangle(part.triangle_count);
    for (uint32_t t = 0; t < part.triangle_count; ++t)
        cell_of_triangle[t] = cell_of_unit[line_of_triangle.empty() ? t : line_of_triangle[t]];
    const std::vector<uint32_t> place_of = sort_triangles(packed, cell_of_triangle, result.cells);
    std::vector<std::vector<uint32_t>> points(result.cells.size()), lines(result.cells.size());
    for (uint32_t i = 0; i < part.point_count; ++i)
        points[cell_of_triangle[packed.point_owners[i]]].push_back(i);
    for (uint32_t& owner : packed.point_owners) owner = place_of[owner];
    for (uint32_t i = 0; i < part.line_count; ++i) lines[cell_of_unit[i]].push_back(i);

    for (size_t c = 0; c < result.cells.size(); ++c) {
        PackedPart& cell = result.cells[c];
        cell.first_point = uint32_t(result.points.size());
        cell.point_count = uint32_t(points[c].size());
        for (uint32_t i : points[c]) {
            result.points.push_back(packed.points[i]);
            result.point_owners.push_back(packed.point_owners[i] - cell.first_triangle);
        }
        const size_t first_line_vertex = result.line_vertices.size();
        cell.first_line = uint32_t(first_line_vertex / 2);
        cell.line_count = uint32_t(lines[c].size());
        for (uint32_t i : lines[c]) {
            result.line_vertices.push_back(packed.line_vertices[2 * size_t(i)]);
            result.line_vertices.push_back(packed.line_vertices[2 * size_t(i) + 1]);
        }
        measure_cell(cell,
                     std::span(packed.triangle_vertices)
                         .subspan(3 * size_t(cell.first_triangle), 3 * size_t(cell.triangle_count)),
                     std::span(result.line_vertices).subspan(first_line_vertex),
                     part.area_m2 / part.line_length_m);
    }
    keep_far_points(packed);
    return result;
}

}  // namespace coppice
