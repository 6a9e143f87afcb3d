#include "plugins/vegetation/cook/build_octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <numeric>

namespace coppice {
namespace {

constexpr uint32_t k_octants = 8;
constexpr uint32_t k_few_triangles = k_cell_least_triangles / 4;

struct Cell {
    uint32_t part;
    vec3 middle_plant;
    float side_m;
    uint32_t depth;
    std::vector<uint32_t> units;
    uint32_t triangle_count;
    bool whole;  // is not cut further
};

// The occupied octants, those with few triangles joined to the next; empty where they are not worth being
// cells.
std::vector<Cell> cut(const Cell& cell, const OctreeUnits& units) {
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

std::vector<std::vector<uint32_t>> build_octree(std::span<const OctreeUnits> parts, const Box& bounds_plant,
                                                uint32_t cell_limit) {
    std::vector<Cell> cells;
    if (!bounds_plant.empty() && 0.5f * glm::length(bounds_plant.size()) > k_octree_least_radius_m) {
        const vec3 size = bounds_plant.size();
        for (uint32_t i = 0; i < parts.size(); ++i) {
            const auto& counts = parts[i].triangle_count;
            const uint32_t triangle_count = std::accumulate(counts.begin(), counts.end(), 0u);
            if (triangle_count < 2 * k_cell_least_triangles) continue;
            std::vector<uint32_t> all(counts.size());
            std::iota(all.begin(), all.end(), 0u);
            cells.push_back({i, bounds_plant.center(), std::max({size.x, size.y, size.z}), 0, std::move(all),
                             triangle_count, false});
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
        std::vector<Cell> smaller = cut(cells[largest], parts[cells[largest].part]);
        if (smaller.empty() || cell_count + smaller.size() - 1 > cell_limit) {
            cells[largest].whole = true;
            continue;
        }
        cell_count += smaller.size() - 1;
        cells.erase(cells.begin() + ptrdiff_t(largest));
        cells.insert(cells.begin() + ptrdiff_t(largest), std::make_move_iterator(smaller.begin()),
                     std::make_move_iterator(smaller.end()));
    }

    std::vector<std::vector<uint32_t>> cell_of_unit;
    for (const OctreeUnits& units : parts) cell_of_unit.emplace_back(units.middle_plant.size(), 0);
    uint32_t number = 0;
    for (size_t c = 0; c < cells.size(); ++c) {
        number = c > 0 && cells[c - 1].part == cells[c].part ? number + 1 : 0;
        for (uint32_t unit : cells[c].units) cell_of_unit[cells[c].part][unit] = number;
    }
    return cell_of_unit;
}

}  // namespace coppice
