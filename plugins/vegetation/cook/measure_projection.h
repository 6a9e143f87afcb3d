// Fits the direction forms of a part (plant.h): what the viewer sees of it from each side.
// ERRATA 2: the printed 1/2 holds for leaves of random orientation only.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/plant/plant.h"
#include "plugins/vegetation/plant/description.h"

namespace coppice {

inline constexpr int k_projection_direction_count = 64;

// Unit vectors, even over a hemisphere: projections do not know front from back.
const std::array<vec3, k_projection_direction_count>& projection_directions();

// Sum of a |n . d| over the triangles, half of it for a closed surface (the front half covers what the back
// half does).
std::array<double, k_projection_direction_count> projected_areas_m2(const PartDescription& part, bool closed);
// Sum of the lengths seen at their angle to d: l |t x d|. Two points a line.
std::array<double, k_projection_direction_count> projected_lengths_m(std::span<const vec3> line_ends_plant);

// Least squares over projection_directions(), scaled so that the mean over them is kept.
DirectionForm fit_direction_form(const std::array<double, k_projection_direction_count>& values);

}  // namespace coppice
