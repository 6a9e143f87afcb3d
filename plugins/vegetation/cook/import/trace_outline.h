// The border of what is opaque in a picture, as closed rings.
// Marching squares on a grid of alpha values, crossings interpolated, saddles decided by the mean of the four
// corners.
#pragma once
#include <cstdint>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

using glm::dvec2;

// Closed; no two neighbours at the same place. The opaque side lies to the left in a system of x right, y up:
// an outer ring has positive signed area, a hole negative.
using Ring = std::vector<dvec2>;

// Twice the signed area of triangle a, b, c.
inline double cross_at(dvec2 a, dvec2 b, dvec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
double signed_area(const Ring& ring);

// Values at the crossings of lines x = xs[i] and y = ys[j], row by row. xs and ys do not fall.
struct AlphaGrid {
    std::vector<double> xs, ys;
    std::vector<float> values;
};

// Rings around values >= threshold, ordered by where they start. What lies at the grid's edge must be below
// threshold, so that all rings close: repeat the outermost lines with a lower value, and rings end exactly
// there.
std::vector<Ring> trace_outline(const AlphaGrid& grid, float threshold);

}  // namespace coppice
