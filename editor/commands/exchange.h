// Placed plants for other programs: tables of places, and glTF nodes.
#pragma once
#include "editor/document/document.h"
#include "plugins/terrain/terrain.h"

namespace coppice {

// x, y (the world's z), species, height where the population's height_m is known, scale, turn_deg. In order of cells.
std::string placed_as_csv(const Document& document, const EcoFile& file);

// One node a plant, below one a population; glTF 2.0 without meshes. On the terrain, or the plane y = 0.
std::string placed_as_gltf(const Document& document, const EcoFile& file, const Terrain* terrain);

}  // namespace coppice
