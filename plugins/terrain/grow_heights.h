// Hills, ridges, a valley and a rim from noise: content needs no big file, and every machine gets the same
// bits.
#pragma once
#include <vector>
#include "plugins/terrain/height_field.h"
#include "plugins/shared/region.h"

namespace coppice {

struct GrowHeightsSettings {
    float size_m = 1000.0f;  // of the square
    float cell_m = 4.0f;     // at most; rounded down so that whole patches fill the square
    uint32_t seed = 1;
    // Copies of the ground stand beside each other without a seam. Not with a rim, a valley or a level place.
    bool periodic = false;
    float amplitude_m = 10.0f;  // two thirds of the ground lie within about half of it
    float wavelength_m = 200.0f;
    uint32_t octaves = 5;
    float roughness = 0.45f;  // strength of each octave over the one before
    float ridges = 0.0f;      // [0, 1]: from round hills to sharp crests
    float rim_m = 0.0f;       // how much higher the border is than the middle
    // A trough along a polyline, local coordinates; smooth over its width, and smoother ground in it.
    std::vector<dvec2> valley;
    float valley_width_m = 100.0f, valley_depth_m = 0.0f;
    // Ground made level towards its own height at the centre: for a clearing or a house.
    dvec2 level_center{0.0};
    float level_radius_m = 0.0f;
};

// Requires sizes in range (load_terrain checks). Same bytes on any number of threads.
HeightField grow_heights(const GrowHeightsSettings& settings);
// Cells along a side of size_m: a multiple of the patch, none longer than cell_m.
uint32_t cells_along(float size_m, float cell_m);

}  // namespace coppice
