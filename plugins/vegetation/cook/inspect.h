// What is inside a packed plant, for people and for programs.
#pragma once
#include <string>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// A table of several lines, one a part; lengths, areas and bytes with their units.
std::string inspect_plant(const Plant& plant);
// The same figures as one JSON object, SI units in the names.
std::string inspect_plant_json(const Plant& plant);

}  // namespace coppice
