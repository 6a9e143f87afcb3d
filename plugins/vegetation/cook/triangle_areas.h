// Areas in m2 of a clean mesh's triangles, each side counted once, and what is weighed by them.
#pragma once
#include <utility>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

std::vector<double> triangle_areas(const PartDescription& part);

// Their sum, and the mean linear colour of the surface. Requires a mesh that is not empty.
std::pair<double, vec3> measure_area_and_color(const PartDescription& part);

}  // namespace coppice
