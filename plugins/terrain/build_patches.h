// The triangles of a height field: square patches, each in several levels of half the resolution of the one
// before. Neighbours may differ in level, so every level hangs a skirt from its border that covers the gap.
#pragma once
#include <vector>
#include "plugins/terrain/height_field.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// error_m is at least this share of a level's spacing, level 0 excepted: vertices carry the colour too, and
// even flat ground must not lose it to a triangle of a hundred metres.
inline constexpr float k_color_error_share = 1.0f / 10.0f;

struct TerrainMesh {
    std::vector<TerrainPatch> patches;
    std::vector<TerrainLevel> levels;
    std::vector<float> least_heights;      // Terrain::least_heights
    std::vector<PackedVertex> vertices;    // surface words are set by color_vertices
    std::vector<uint32_t> vertex_samples;  // which sample of the field a vertex shows
    std::vector<uint8_t> vertex_level;     // of each level's vertices, by level index: log2 of its spacing
};

// Levels halve as long as their spacing divides the patch: all of them but at the border of a field whose
// cells are no multiple of k_patch_cells.
TerrainMesh build_patches(const HeightField& field);

// What each sample shows.
struct GroundSurface {
    std::vector<vec3> normals;        // unit
    std::vector<vec3> colors_linear;  // [0, 1]
    std::vector<float> light;         // [0, 1]: what is left of colour and openness after shading
};

// Sets the surface words. Coarser levels show the mean of the samples they stand for, so no level changes the
// mean.
void color_vertices(const HeightField& field, const GroundSurface& ground, TerrainMesh& mesh);

}  // namespace coppice
