// The stem of a plant as a capsule: what bodies and rays meet, whatever its crown.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// All points at most radius_m from the line between foot and head.
struct StemShape {
    vec3 foot_plant{0.0f}, head_plant{0.0f};
    float radius_m = 0.0f;  // 0: none; grass and ferns are walked through
};

// Of the wood: what is no leaf, followed upwards from the lowest of it in slabs, as far as it goes on near where it was: to the tip, or
// to where a trunk forks. The radius is the mean over the lower half, so that neither the flare of the roots nor the tip decides.
StemShape measure_stem(const Plant& plant);

// Where one stands, as the world has it.
struct Stem {
    dvec3 foot_world{0.0}, head_world{0.0};
    float radius_m = 0.0f;
    uint32_t plant = 0;  // the host's number of it; of a scene the row of its arrays
};
Stem place_stem(const StemShape& shape, dvec3 place_world, PlantTurn turn, float scale, uint32_t plant);

// Of all plants of a scene that have one, in the order of its rows. shapes: of its models.
std::vector<Stem> stems_of(const Scene& scene, std::span<const StemShape> shapes);

}  // namespace coppice
