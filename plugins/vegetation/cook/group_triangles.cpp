#include "plugins/vegetation/cook/group_triangles.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace coppice {
namespace {

float longest_edge_square(const PackedVertex* v) {
    auto square = [](const PackedVertex& a, const PackedVertex& b) {
        const vec3 edge(b.x_plant - a.x_plant, b.y_plant - a.y_plant, b.z_plant - a.z_plant);
        return glm::dot(edge, edge);
    };
    return std::max({square(v[0], v[1]), square(v[1], v[2]), square(v[2], v[0])});
}

// place_of[i]: where triangle i of the run goes.
void order_run(std::span<const float> sizes, std::span<uint32_t> place_of) {
    const uint32_t count = uint32_t(sizes.size());
    std::array<uint32_t, k_triangles_a_run> by_size, groups;
    std::iota(by_size.begin(), by_size.begin() + count, 0u);
    std::sort(by_size.begin(), by_size.begin() + count, [&](uint32_t a, uint32_t b) {
        return sizes[a] != sizes[b] ? sizes[a] > sizes[b] : a < b;
    });
    const uint32_t group_count = count / k_triangles_a_lane_group;  // whole ones; what is left stays last
    auto first_of = [&](uint32_t group) {
        const auto begin = by_size.begin() + group * k_triangles_a_lane_group;
        return *std::min_element(begin, begin + k_triangles_a_lane_group);
    };
    std::array<uint32_t, k_triangles_a_run / k_triangles_a_lane_group> first;
    for (uint32_t g = 0; g < group_count; ++g) first[g] = first_of(g);
    std::iota(groups.begin(), groups.begin() + group_count, 0u);
    std::sort(groups.begin(), groups.begin() + group_count,
              [&](uint32_t a, uint32_t b) { return first[a] < first[b]; });
    uint32_t next = 0;
    for (uint32_t g = 0; g < group_count; ++g) {
        const auto begin = by_size.begin() + groups[g] * k_triangles_a_lane_group;
        std::sort(begin, begin + k_triangles_a_lane_group);
        for (uint32_t k = 0; k < k_triangles_a_lane_group; ++k) place_of[begin[k]] = next++;
    }
    for (uint32_t i = group_count * k_triangles_a_lane_group; i < count; ++i) place_of[by_size[i]] = next++;
}

}  // namespace

void group_triangles(PlantBlocks& plant) {
    const size_t triangle_count = plant.triangle_vertices.size() / 3;
    std::vector<uint32_t> place_of(triangle_count);
    std::iota(place_of.begin(), place_of.end(), 0u);
    std::vector<uint8_t> is_cut(plant.parts.size());
    for (const PackedPart& cell : plant.cells) is_cut[cell.part] = 1;

    auto group = [&](const PackedPart& part) {
        std::array<float, k_triangles_a_run> sizes;
        for (uint32_t first = 0; first < part.triangle_count; first += k_triangles_a_run) {
            const uint32_t count = std::min(k_triangles_a_run, part.triangle_count - first);
            const size_t begin = size_t(part.first_triangle) + first;
            for (uint32_t i = 0; i < count; ++i)
                sizes[i] = longest_edge_square(&plant.triangle_vertices[3 * (begin + i)]);
            const std::span<uint32_t> places = std::span(place_of).subspan(begin, count);
            order_run(std::span(sizes).first(count), places);
            for (uint32_t& place : places) place += uint32_t(begin);
        }
    };
    for (size_t p = 0; p < plant.parts.size(); ++p)
        if (!is_cut[p]) group(plant.parts[p]);
    for (const PackedPart& cell : plant.cells) group(cell);

    std::vector<PackedVertex> sorted(plant.triangle_vertices.size());
    for (size_t t = 0; t < triangle_count; ++t)
        std::copy_n(&plant.triangle_vertices[3 * t], 3, &sorted[3 * size_t(place_of[t])]);
    plant.triangle_vertices = std::move(sorted);
    auto follow = [&](const PackedPart& part) {
        for (uint32_t i = part.first_point; i < part.first_point + part.point_count; ++i)
            plant.point_owners[i] = place_of[part.first_triangle + plant.point_owners[i]] - part.first_triangle;
    };
    for (const PackedPart& part : plant.parts) follow(part);
    for (const PackedPart& cell : plant.cells) follow(cell);
}

}  // namespace coppice
