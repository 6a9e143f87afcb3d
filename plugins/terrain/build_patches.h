// The triangles of a height field: square patches, each in several levels of half the resolution of the one
// before. Neighbours may differ in level, so every level hangs a skirt from its border that covers the gap.
#pragma once
#include <vector>
#include "plugins/terrain/height_field.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// The samples of the field that a level shows.
struct LevelGrid {
    uint32_t first_column, first_row;  // of its corner of least x and z
    uint32_t shift;                    // log2 of its spacing in cells
    uint32_t across, down;             // samples along x and z
    uint32_t first_word;               // of the surface words, row by row
    float skirt_m;                     // how deep its skirts hang
};

// All but what it looks like.
struct TerrainMesh {
    std::vector<TerrainPatch> patches;
    std::vector<TerrainLevel> levels;
    std::vector<LevelGrid> grids;      // one a level
    std::vector<float> least_heights;  // Terrain::least_heights
    uint32_t vertex_count = 0, word_count = 0;
    Box bounds() const;
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

// One surface word a sample of each level, where its grid says. Coarser levels show the mean of the samples they stand
// for, so no level changes the mean.
std::vector<uint32_t> color_levels(const HeightField& field, const GroundSurface& ground,
                                   const TerrainMesh& mesh);

// Of all levels, where they say, or of one. Requires the words of all grids, and room for as many as there are.
void write_vertices(const HeightField& field, const TerrainMesh& mesh, std::span<const uint32_t> words,
                    std::span<PackedVertex> all);
void write_level(const HeightField& field, const TerrainMesh& mesh, uint32_t level,
                 std::span<const uint32_t> words, std::span<PackedVertex> of_level);

}  // namespace coppice
