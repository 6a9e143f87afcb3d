// Areas in m2 of a clean mesh's triangles, each side counted once.
#pragma once
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

std::vector<double> triangle_areas(const PartDescription& part);

}  // namespace coppice
