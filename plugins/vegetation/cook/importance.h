// Importance from colour: petals in a meadow catch the eye, so they keep more primitives than the green
// around them. Deussen et al. 2002 leave this to the user and name the analysis of colours as future work
// (ERRATA 5).
#pragma once
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

struct ColoredArea {
    vec3 mean_color_linear;
    double area_m2;
    float given;  // > 0: the author's factor, which is kept
};

// One factor a part, in [1, 4] where it is not given: how far the part's colour is from the plant's majority
// colour (that of the largest group of like-coloured parts by area), in OKLab, with differences of lightness
// counted less, because shading makes them everywhere. Ordinary greens and bark stay at 1. Time grows with
// the square of the number of parts: merge_parts first.
std::vector<float> choose_importance(std::span<const ColoredArea> parts);

}  // namespace coppice
