// Darkens the ground under crowns, a little away from the sun: what stands on a meadow must touch it.
#pragma once
#include <span>
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

// Once, after cooking and before the terrain is drawn: model_bounds_plant[i] is Plant::bounds_plant of
// scene.models[i]. terrain is usually *scene.terrain. Plants under half a metre leave no mark.
void shade_ground(const Scene& scene, Terrain& terrain, std::span<const Box> model_bounds_plant);

}  // namespace coppice
