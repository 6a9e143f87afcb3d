// How much more or less of a part's projected area its points or lines must be drawn with, so that they cover
// as many pixels as its triangles do. Triangles hide one another in another way than points strewn over them:
// where leaves are larger than a pixel, points fall on each other and leave gaps; where leaves are much
// smaller, well spread points overlap less than leaves on a twig do. The paper's splat factor c_p (1.2
// to 1.5) is one number for this; here it is measured, for every part and size on the screen
// (docs/decisions.md).
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// Vertices as the part's triangles, points and lines have them (plant.h). Draws the part on the CPU by the
// rules of the kernels, from directions over the upper hemisphere, at one pixel of sample distance. Pure.
std::array<float, k_gain_levels> measure_coverage_gain(const PackedPart& part,
                                                       std::span<const PackedVertex> triangle_vertices,
                                                       std::span<const PackedVertex> points,
                                                       std::span<const PackedVertex> line_vertices);

}  // namespace coppice
