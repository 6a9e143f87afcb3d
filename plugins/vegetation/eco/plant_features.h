// What an individual looks like beside the others of its kind, in a few numbers. Pure: same plant, same bits.
#pragma once
#include "plugins/vegetation/plant/description.h"

namespace coppice {

// Of what a cook would need minutes to tell nothing is here: all follows from the plant as described. Plant space.
struct PlantFeatures {
    float height_m;      // of the top above the foot; > 0
    float crown_base_m;  // a twentieth of the leaf area hangs lower
    float crown_width_x_m, crown_width_z_m;
    // Surface seen along each axis, each leaf and the front half of each stem counted whole, whatever hides it.
    float area_along_x_m2, area_along_y_m2, area_along_z_m2;
    float leaf_area_m2;
    float leaf_red, leaf_green, leaf_blue;  // linear, mean over the leaf area
};
static_assert(sizeof(PlantFeatures) == 44);  // cached as bytes

// Goes into the key of what is cached: raise it when the same plant gives other features.
inline constexpr uint32_t k_features_version = 1;

// A plant without leaves has its stems for a crown. Triangles that are not finite are left out; nothing is NaN.
PlantFeatures measure_features(const PlantDescription& plant);

}  // namespace coppice
