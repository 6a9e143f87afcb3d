// A whole terrain as a few triangles, for where it is one of many in the distance: grids of 1, 2, 4 ... cells a side, with
// skirts that hide what opens between neighbours of different grids.
#pragma once
#include <vector>
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

struct CoarseGround {
    struct Level {
        uint32_t first_vertex, vertex_count;  // three a triangle
        // Largest vertical distance to the terrain's samples, at least k_color_error_share of its vertices' spacing.
        float error_m;
    };
    std::vector<Level> levels;           // the coarsest first
    std::vector<PackedVertex> vertices;  // in the space of the terrain's scene
};

inline constexpr uint32_t k_coarse_ground_levels = 5;

// Of a terrain whose layout is told; else no levels.
CoarseGround make_coarse_ground(const Terrain& terrain);
// One square at the lowest height, so that nothing that stands on the ground is below it; error_m: the difference in height.
CoarseGround make_flat_ground(const Box& bounds, vec3 color_linear);

}  // namespace coppice
