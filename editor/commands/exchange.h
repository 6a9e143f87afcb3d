// Placed plants for other programs: tables of places, and glTF nodes.
#pragma once
#include "editor/document/document.h"
#include "plugins/terrain/terrain.h"

namespace coppice {

// x, y (the world's z), species, height where the population's height_m is known, scale, turn_deg. In order of cells.
std::string placed_as_csv(const Document& document, const EcoFile& file);

// glTF 2.0 with EXT_mesh_gpu_instancing: for each individual of a population a node "NAME.003" with all its plants, whose mesh is a
// pyramid of a metre called like the population. On the terrain, or the plane y = 0. binary: as .glb, else a text. What is imported
// of it again is the same plants; heights above the ground to a step of 1/64 m.
std::string placed_as_gltf(const Document& document, const EcoFile& file, const Terrain* terrain, bool binary = false);

}  // namespace coppice
