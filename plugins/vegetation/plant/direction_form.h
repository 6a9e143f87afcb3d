// Fits direction forms (plant.h) to what is seen from each side, and takes their mean.
#pragma once
#include <array>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

inline constexpr int k_projection_direction_count = 64;
using DirectionValues = std::array<double, k_projection_direction_count>;

// Unit vectors, even over a hemisphere: projections do not know front from back.
const std::array<vec3, k_projection_direction_count>& projection_directions();

// Least squares over projection_directions(), scaled so that the mean over them is kept.
DirectionForm fit_direction_form(const DirectionValues& values);
double mean_over_directions(const DirectionForm& form);

}  // namespace coppice
