#include "plugins/vegetation/cook/weld_positions.h"

#include <algorithm>
#include <bit>
#include "runtime/core/hash.h"

namespace coppice {

std::vector<uint32_t> weld_positions(const std::vector<DescriptionVertex>& vertices) {
    constexpr uint32_t k_empty = UINT32_MAX;
    constexpr double k_reach = 2e-6,
                     k_cell = 1.0 / (8.0 * k_reach);  // cells of four times the reach each way
    Box box;
    for (const DescriptionVertex& v : vertices) box.include(v.position_plant);
    vec3 size = vertices.empty() ? vec3(1) : box.size();
    double extent = std::max({double(size.x), double(size.y), double(size.z), 1e-20});

    // An open hash of cells; vertices that stand for themselves hang in a list from their cell.
    size_t slot_count = std::bit_ceil(vertices.size() * 2 + 1);
    std::vector<uint32_t> slots(slot_count, k_empty), next(vertices.size(), k_empty), welded(vertices.size());
    auto slot_of = [&](const int64_t cell[3]) {
        uint32_t hash = mix_bits(uint32_t(cell[0]));
        hash = mix_bits(hash ^ uint32_t(cell[1]));
        hash = mix_bits(hash ^ uint32_t(cell[2]));
        return size_t(hash) &
               (slot_count - 1);  // different cells may share a list: distances are compared anyway
    };
    for (uint32_t i = 0; i < vertices.size(); ++i) {
        dvec3 place = (dvec3(vertices[i].position_plant) - dvec3(box.min)) * (1.0 / extent);
        int64_t low[3], high[3], own[3];
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = int64_t((place[axis] - k_reach) * k_cell + 1.0);
            high[axis] = int64_t((place[axis] + k_reach) * k_cell + 1.0);
            own[axis] = int64_t(place[axis] * k_cell + 1.0);
        }
        uint32_t first = i;
        int64_t cell[3];
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2])
            for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1])
                for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0])
                    for (uint32_t other = slots[slot_of(cell)]; other != k_empty; other = next[other]) {
                        dvec3 away =
                            dvec3(vertices[other].position_plant) - dvec3(vertices[i].position_plant);
                        double reach = k_reach * extent;
                        if (other < first && glm::dot(away, away) <= reach * reach) first = other;
                    }
        welded[i] = first;
        if (first != i) continue;
        size_t slot = slot_of(own);
        next[i] = slots[slot];
        slots[slot] = i;
    }
    return welded;
}

}  // namespace coppice
