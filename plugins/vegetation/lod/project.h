// Projected area and length of a part on the screen, in pixels (DESIGN section 3, ERRATA 2 and 3).
#pragma once
#include "plugins/vegetation/lod/settings.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// How a plant stands to the viewer; shared by all its parts.
struct PlantView {
    vec3 direction_plant;    // unit, from the viewer to the plant, in plant space
    float pixels_per_meter;  // on the image at the plant's distance, times its scale: f / r * scale. Finite, >= 0
};

// pixels_per_meter for a plant whose centre is distance_m away. r is clamped below at r_min_m, so that a viewer inside
// a plant gets a large but finite number (ERRATA 3).
inline float pixels_per_meter(float focal_px, float distance_m, float r_min_m, float scale) {
    float r = distance_m > r_min_m ? distance_m : r_min_m;
    return focal_px / r * scale;
}

// A'_p in square pixels: what the part would cover if none of it hid another piece of it.
float projected_area_px2(const PackedPart& part, const PlantView& view, ProjectionMode mode);
// l' in pixels: length of all its lines.
float projected_length_px(const PackedPart& part, const PlantView& view, ProjectionMode mode);

}  // namespace coppice
