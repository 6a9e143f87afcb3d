// What the viewer sees of a part from each side, for plant/direction_form.h to fit.
// ERRATA 2: the printed 1/2 holds for leaves of random orientation only.
#pragma once
#include <span>
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/direction_form.h"

namespace coppice {

// Sum of a |n . d| over the triangles, half of it for a closed surface (the front half covers what the back
// half does).
DirectionValues projected_areas_m2(const PartDescription& part, bool closed);
// Sum of the lengths seen at their angle to d: l |t x d|. Two points a line.
DirectionValues projected_lengths_m(std::span<const vec3> line_ends_plant);

}  // namespace coppice
