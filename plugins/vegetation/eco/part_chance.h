// What a plant's part draws by chance: how it rounds the number of its points or lines to a whole one, and with which point
// it begins.
#pragma once
#include "plugins/vegetation/components.h"
#include "runtime/core/hash.h"

namespace coppice {

// In [0, 1): of `asked`, a part draws floor(asked + chance). part: index within its plant.
inline float part_chance(uint32_t seed, uint32_t part) {
    return float(int32_t(mix_bits(seed + part * 0x9e3779b9u) >> 8)) * 0x1p-24f;
}
inline float part_chance(PlantModel plant, uint32_t part) { return part_chance(plant.seed, part); }

// In [0, mask], mask one less than a power of two: plant/point_run.h. Of other bits than the chance.
inline uint32_t first_point_of(uint32_t seed, uint32_t part, uint32_t mask) {
    return mix_bits(seed + part * 0x9e3779b9u + 0x6a09e667u) & mask;
}

}  // namespace coppice
