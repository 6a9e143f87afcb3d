// Cuts placements into square tiles and sorts them inside, so that neighbours lie together in memory and a
// tile's plants of one model follow each other.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/eco/place.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

inline constexpr uint32_t k_tile_plant_limit = 1024;
inline constexpr double k_tile_least_side_m =
    0.5;  // more plants than the limit on less ground share it over tiles

// Fills tiles, positions, turns and plant_models. Every placement comes into exactly one tile; a tile's
// origin is the middle of its square, rounded to 1/16 m, at the mean height of its plants. Order: tiles along
// a Morton curve, plants by model, then along the curve, then as they came. Bounds hold the plants' feet
// only, until finish_tiles.
void make_tiles(std::span<const Placement> placements, Scene& scene);

// To be called once the plants are cooked, and before the scene is drawn: model_bounds_plant[i] is
// Plant::bounds_plant of scene.models[i]. Sets every tile's bounds_tile. Requires
// one box a model.
void finish_tiles(Scene& scene, std::span<const Box> model_bounds_plant);

}  // namespace coppice
