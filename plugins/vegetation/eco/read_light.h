// Sun, sky, haze and exposure, as an author writes them.
#pragma once
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/components.h"

namespace coppice {

// Azimuth clockwise from -z (north), as on a compass; elevation over the horizon.
vec3 direction_to_sun(float azimuth_deg, float elevation_deg);

// Of the scene's or mosaic's root; faults go to the document.
Light read_light(JsonObject& root);

}  // namespace coppice
