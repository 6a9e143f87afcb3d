// Plants that a person or a program placed one by one, in 18 bytes each: the editor's, and the placement "packed" of a
// scene. What is kept is what is shown: a plant is rounded once, when it is placed.
#pragma once
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "plugins/shared/region.h"
#include "plugins/vegetation/eco/place.h"
#include "runtime/core/result.h"

namespace coppice {

inline constexpr double k_placed_steps_per_m = 128.0;  // of x and z: they reach 16,777 km
inline constexpr double k_lift_steps_per_m = 64.0;     // of the height above the ground: up to 511 m

struct PlacedPlant {
    int32_t x = 0, z = 0;    // in steps
    uint16_t kind = 0;       // whose name, says the list that it comes with
    uint16_t variation = 0;  // which of the kind's individuals
    uint32_t turn = 0;       // pack_placed_turn
    uint16_t scale = 0;      // pack_scale
    int16_t lift = 0;        // steps above the ground
    auto operator<=>(const PlacedPlant&) const = default;
};

// 5 bits of exponent, 11 of mantissa: within 0.025 % from 1.6e-5 to 65504, clamped there. Monotone.
uint16_t pack_scale(float scale);
float unpack_scale(uint16_t packed);
// The quaternion's three smaller parts in 10 bits each: within a quarter of a degree; upright plants stay upright.
uint32_t pack_placed_turn(PlantTurn turn);
PlantTurn unpack_placed_turn(uint32_t packed);

// Rounded and clamped to what can be kept. y counts from the ground.
PlacedPlant pack_placed(dvec3 position, float scale, PlantTurn turn, uint16_t kind, uint16_t variation);
inline dvec2 ground_place(const PlacedPlant& plant) {
    return {plant.x / k_placed_steps_per_m, plant.z / k_placed_steps_per_m};
}
// What stands there. kind: of the scene; the individual counts from the first again where it has fewer. Its seed follows
// from where it stands, so that neighbours do not lose the same leaves.
Placement unpack_placed(const PlacedPlant& plant, const PlantKind& kind, double ground_y_world);

// A file, in memory: plants[i].kind counts in kinds.
struct PlacedPlants {
    std::vector<std::string> kinds;  // names of the scene's plants
    std::vector<PlacedPlant> plants;
};

// Sorted by the kind's name, then by the plants' own order: the same plants are the same bytes, however they came to be.
// Kinds without a plant are left out.
std::string write_placed(const PlacedPlants& placed);
// Errors, with the byte: format_unknown, file_truncated, file_corrupt, limit_exceeded.
Result<PlacedPlants> read_placed(std::string_view bytes, const std::string& path);

}  // namespace coppice
