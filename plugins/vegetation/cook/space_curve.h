// Neighbours in space made neighbours in a list: the position of a point along a three-dimensional Hilbert
// curve.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

// Indices of `points` in the order in which a Hilbert curve of 1024 cells a side through their box meets
// them; ties by index. Parallel. Requires finite points, fewer than 2^32.
std::vector<uint32_t> order_along_curve(std::span<const vec3> points);

}  // namespace coppice
