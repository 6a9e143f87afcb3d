#include "plugins/vegetation/cook/weld_positions.h"

#include <bit>
#include "runtime/core/hash.h"

namespace coppice {

std::vector<uint32_t> weld_positions(const std::vector<DescriptionVertex>& vertices) {
    constexpr uint32_t k_empty = UINT32_MAX;
    size_t slot_count = std::bit_ceil(vertices.size() * 2 + 1);
    std::vector<uint32_t> slots(slot_count, k_empty);
    std::vector<uint32_t> welded(vertices.size());
    for (uint32_t i = 0; i < vertices.size(); ++i) {
        vec3 p = vertices[i].position_plant + vec3(0.0f);  // turns -0 into 0
        uint32_t hash = mix_bits(std::bit_cast<uint32_t>(p.x));
        hash = mix_bits(hash ^ std::bit_cast<uint32_t>(p.y));
        hash = mix_bits(hash ^ std::bit_cast<uint32_t>(p.z));
        size_t slot = hash & (slot_count - 1);
        while (slots[slot] != k_empty && vertices[slots[slot]].position_plant != p)
            slot = (slot + 1) & (slot_count - 1);
        if (slots[slot] == k_empty) slots[slot] = i;
        welded[i] = slots[slot];
    }
    return welded;
}

}  // namespace coppice
