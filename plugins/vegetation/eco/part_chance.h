// The chance by which a plant's part rounds the number of its points or lines to a whole one.
#pragma once
#include "plugins/vegetation/components.h"
#include "runtime/core/hash.h"

namespace coppice {

// In [0, 1): of `asked`, a part draws floor(asked + chance). part: index within its plant.
inline float part_chance(uint32_t seed, uint32_t part) {
    return float(int32_t(mix_bits(seed + part * 0x9e3779b9u) >> 8)) * 0x1p-24f;
}
inline float part_chance(PlantModel plant, uint32_t part) { return part_chance(plant.seed, part); }

}  // namespace coppice
