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

// A kind of plant: its individuals are the models [first_model, first_model + variation_count).
struct PlantKind {
    uint32_t first_model = 0;
    uint32_t variation_count = 1;
    float height_m = 0.0f;  // of the model at scale 1; 0: not known
};

// Upright plant turned by turn_rad about its stem, then leaning by lean_rad so that its tip moves towards
// `towards` (horizontal unit vector).
PlantTurn make_turn(float turn_rad, float lean_rad, vec3 towards);

}  // namespace coppice
