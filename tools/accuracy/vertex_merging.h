// Coarser meshes by merging vertices, the method every simplification was long compared with.
// Source: Rossignac and Borrel 1993, Multi-resolution 3D approximations for rendering complex scenes.
// Deviates: a cell's vertices become their mean by the area of the triangles they belong to, where the paper weighs
// them by curvature and size; triangles that collapse to an edge or a point are dropped, where the paper draws lines
// and dots, so that thin parts fade away.
#pragma once
#include "tools/accuracy/substitute_models.h"

namespace coppice {

// The plant's triangles (no points, no lines) after all vertices of a part that lie in one cube of side cell_m have
// become one; the cubes' grid starts at the least corner of the plant's bounds. Normal, colour and openness are
// averaged likewise. Of triangles with the same three corners the first is kept; the order stays. Parts of which
// nothing is left are left out, so a plant may have none. cell_m is raised to a millionth of the plant where it is
// less. Same plant, same bytes. Errors: load_plant_from_memory's.
Result<Plant> merge_vertices(const Plant& plant, float cell_m);

// The full geometry, then cells doubling from the plant's median edge up to half its largest extent, as long as a
// triangle is left.
Result<SubstituteLadder> make_vertex_merging_ladder(const Plant& plant);

}  // namespace coppice
