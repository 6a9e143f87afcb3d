// Sun, sky, haze and exposure, as an author writes them.
#pragma once
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/components.h"

namespace coppice {

// Of the scene's or mosaic's root; faults go to the document.
Light read_light(JsonObject& root);

}  // namespace coppice
