// A level of a crown as a packed plant, drawn by all its triangles: for pictures and the time of drawing.
#pragma once
#include <span>
#include "plugins/vegetation/cook/openness.h"
#include "plugins/vegetation/plant/leaf.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// The leaves in place of all of the plant's leaf parts; with_wood: and its other parts' triangles. Bounds are the plant's.
// Requires a plant with a leaf part. Errors: load_plant_from_memory's.
Result<Plant> make_level_plant(const Plant& plant, std::span<const Leaf> leaves, const OpennessGrid& openness,
                               bool with_wood);

}  // namespace coppice
