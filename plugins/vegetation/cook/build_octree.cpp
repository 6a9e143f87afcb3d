#include "plugins/vegetation/cook/build_octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include "plugins/vegetation/cook/triangle_areas.h"

namespace coppice {
namespace {

constexpr uint32_t k_octants = 8;
constexpr uint32_t k_few_triangles = k_cell_least_triangles / 4;

// What goes to one cell as a whole: a segment of a stem, a leaf, or a triangle where leaves are not known apart.
struct Units {
    std::vector<uint32_t> of_triangle;
    std::vector<uint32_t> triangle_count;
    std::vector<vec3> middle_plant;
};

Units list_units(const SlenderPart& shape) {
    const PartDescription& mesh = shape.part;
    const auto& elements = mesh.element_first_triangle;
    Units units;
    units.of_triangle.resize(mesh.indices.size() / 3);
    size_t unit_count = units.of_triangle.size();
    if (mesh.kind == PartKind::lines) {
        units.of_triangle = shape.skeleton.triangle_segment;
        unit_count = shape.skeleton.segments.size();
    } else if (!elements.empty()) {
        unit_count = elements.size() - 1;
        for (uint32_t e = 0; e < unit_count; ++e)
            std::fill(units.of_triangle.begin() + elements[e], units.of_triangle.begin() + elements[e + 1],
                      e);
    } else {
        std::iota(units.of_triangle.begin(), units.of_triangle.end(), 0u);
    }
    units.triangle_count.assign(unit_count, 0);
    std::vector<dvec3> corners(unit_count, dvec3(0.0));
    for (size_t t = 0; t < units.of_triangle.size(); ++t) {
        ++units.triangle_count[units.of_triangle[t]];
        for (size_t k = 0; k < 3; ++k)
            corners[units.of_triangle[t]] += dvec3(mesh.vertices[mesh.indices[3 * t + k]].position_plant);
    }
    for (size_t u = 0; u < unit_count; ++u)
        if (mesh.kind == PartKind::lines) {
            const SkeletonSegment& segment = shape.skeleton.segments[u];
            units.middle_plant.push_back((segment.begin_plant + segment.end_plant) * 0.5f);
        } else {
            units.middle_plant.push_back(
                vec3(corners[u] * (1.0 / (3.0 * std::max(units.triangle_count[u], 1u)))));
        }
    return units;
}

struct Cell {
    uint32_t part;
    vec3 middle_plant;
    float side_m;
    uint32_t depth;
    std::vector<uint32_t> units;
    uint32_t triangle_count;
    bool whole;  // is not cut further
};

// The occupied octants, those with few triangles joined to the next; empty where they are not worth being cells.
std::vector<Cell> cut(const Cell& cell, const Units& units) {
    if (cell.depth == k_octree_depth_limit || cell.side_m < 2.0f * k_cell_least_side_m) return {};
    auto octant_of = [&](uint32_t unit) {
        const vec3 p = units.middle_plant[unit] - cell.middle_plant;
        return uint32_t(p.x >= 0.0f) | uint32_t(p.y >= 0.0f) << 1 | uint32_t(p.z >= 0.0f) << 2;
    };
    std::array<uint32_t, k_octants> triangle_count{}, host{};
    for (uint32_t unit : cell.units) triangle_count[octant_of(unit)] += units.triangle_count[unit];
    uint32_t cell_count = 0;
    for (uint32_t o = 0; o < k_octants; ++o) cell_count += triangle_count[o] >= k_few_triangles;
    if (cell_count == 0 || cell.triangle_count / cell_count < k_cell_least_triangles) return {};
    for (uint32_t o = 0; o < k_octants; ++o) {
        auto steps_to = [&](uint32_t other) { return std::popcount(o ^ other); };
        host[o] = UINT32_MAX;
        for (uint32_t other = 0; other < k_octants; ++other)
            if (triangle_count[other] >= k_few_triangles &&
                (host[o] == UINT32_MAX || steps_to(other) < steps_to(host[o])))
                host[o] = other;
    }
    std::array<std::vector<uint32_t>, k_octants> shares;
    for (uint32_t unit : cell.units) shares[host[octant_of(unit)]].push_back(unit);
    std::vector<Cell> cells;
    for (uint32_t o = 0; o < k_octants; ++o) {
        if (shares[o].empty()) continue;
        const vec3 corner(o & 1u ? 1.0f : -1.0f, o & 2u ? 1.0f : -1.0f, o & 4u ? 1.0f : -1.0f);
        Cell& part =
            cells.emplace_back(Cell{cell.part, cell.middle_plant + corner * (0.25f * cell.side_m),
                                    0.5f * cell.side_m, cell.depth + 1, std::move(shares[o]), 0, false});
        for (uint32_t unit : part.units) part.triangle_count += units.triangle_count[unit];
    }
    return cells;
}

}  // namespace

std::vector<std::vector<CookPart>> build_octree(std::vector<CookPart> parts, uint32_t part_limit) {
    Box box;
    for (const CookPart& part : parts)
        for (const DescriptionVertex& v : part.shape.part.vertices) box.include(v.position_plant);
    std::vector<Units> units(parts.size());
    std::vector<Cell> cells;
    if (!box.empty() && 0.5f * glm::length(box.size()) > k_octree_least_radius_m) {
        const float side_m = std::max({box.size().x, box.size().y, box.size().z});
        for (uint32_t i = 0; i < parts.size(); ++i) {
            const uint32_t triangle_count = uint32_t(parts[i].shape.part.indices.size() / 3);
            if (triangle_count < 2 * k_cell_least_triangles) continue;
            units[i] = list_units(parts[i].shape);
            std::vector<uint32_t> all(units[i].middle_plant.size());
            std::iota(all.begin(), all.end(), 0u);
            cells.push_back({i, box.center(), side_m, 0, std::move(all), triangle_count, false});
        }
    }
    size_t cell_count = parts.size();
    for (;;) {
        size_t largest = cells.size();
        for (size_t c = 0; c < cells.size(); ++c)
            if (!cells[c].whole &&
                (largest == cells.size() || cells[c].triangle_count > cells[largest].triangle_count))
                largest = c;
        if (largest == cells.size()) break;
        std::vector<Cell> smaller = cut(cells[largest], units[cells[largest].part]);
        if (smaller.empty() || cell_count + smaller.size() - 1 > part_limit) {
            cells[largest].whole = true;
            continue;
        }
        cell_count += smaller.size() - 1;
        cells.erase(cells.begin() + ptrdiff_t(largest));
        cells.insert(cells.begin() + ptrdiff_t(largest), std::make_move_iterator(smaller.begin()),
                     std::make_move_iterator(smaller.end()));
    }

    std::vector<std::vector<CookPart>> cells_of_part(parts.size());
    for (uint32_t i = 0, first = 0, last; i < parts.size(); ++i, first = last) {
        for (last = first; last < cells.size() && cells[last].part == i; ++last) continue;
        if (last - first < 2) {
            cells_of_part[i].push_back(std::move(parts[i]));
            continue;
        }
        const SlenderPart& shape = parts[i].shape;
        std::vector<uint32_t> piece_of_unit(units[i].middle_plant.size()), piece_of_triangle;
        for (uint32_t c = first; c < last; ++c)
            for (uint32_t unit : cells[c].units) piece_of_unit[unit] = c - first;
        for (uint32_t unit : units[i].of_triangle) piece_of_triangle.push_back(piece_of_unit[unit]);
        for (SlenderPart& piece :
             take_pieces(shape, piece_of_triangle,
                         std::span(piece_of_unit).first(shape.skeleton.segments.size()), last - first)) {
            CookPart& cell = cells_of_part[i].emplace_back(CookPart{std::move(piece), parts[i].closed});
            std::tie(cell.area_m2, cell.mean_color_linear) = measure_area_and_color(cell.shape.part);
        }
    }
    return cells_of_part;
}

}  // namespace coppice
