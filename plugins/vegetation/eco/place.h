// One plant of a scene before it is sorted into a tile.
#pragma once
#include <vector>
#include "plugins/vegetation/components.h"

namespace coppice {

struct Placement {
    dvec3 position_world;  // foot
    float scale;
    PlantTurn turn;
    PlantModel model;
};

inline constexpr size_t k_plant_limit = 20'000'000;  // of a scene

// What an individual is drawn as: itself, or another of its kind that is scaled to its height.
struct PlantIndividual {
    uint32_t model = 0;
    float scale = 1.0f;  // multiplies its placement's
};

struct PlantKind {
    std::vector<PlantIndividual> individuals{
        PlantIndividual{}};  // at least one; placements get one by chance
    float height_m = 0.0f;   // of the model at scale 1; 0: not known
};

// Upright plant turned by turn_rad about its stem, then leaning by lean_rad so that its tip moves towards
// `towards` (horizontal unit vector).
PlantTurn make_turn(float turn_rad, float lean_rad, vec3 towards);

}  // namespace coppice
