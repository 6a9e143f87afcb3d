// Colours by how different they look. Source: B. Ottosson, A perceptual color space for image processing,
// 2020.
#pragma once
#include "runtime/core/math.h"

namespace coppice {

// Lightness, green to red, blue to yellow of a linear colour in [0, 1].
vec3 to_oklab(vec3 color_linear);

}  // namespace coppice
