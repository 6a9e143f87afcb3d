// A packed plant as a table for people.
#pragma once
#include <string>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

std::string describe_plant(const Plant& plant);

}  // namespace coppice
