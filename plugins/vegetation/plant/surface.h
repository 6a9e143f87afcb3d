// What a drawn pixel knows of the surface it shows, in 32 bits, so that lighting needs no second fetch
// (DESIGN 4):
//   bits  0-11  unit normal, octahedral, 6 + 6 bits        (error of direction under 3.9 degrees)
//   bits 12-27  colour, 5 + 6 + 5 bits, square-root coded  (linear = (q / max)^2)
//   bits 28-30  openness, 8 steps: share of the sky seen from here past the plant's own parts
//   bit  31     1: leaf, lit from both sides and letting light through; 0: opaque
// The shaders have the same layout in draw/surface.glsl.
#pragma once
#include <cstdint>
#include "runtime/core/math.h"

namespace coppice {

struct Surface {
    vec3 normal;        // unit
    vec3 color_linear;  // [0, 1]
    float openness;     // [0, 1]
    bool leaf;
};

// Colour and openness are rounded up or down by `dither` (any well mixed bits), so that the mean over many is
// the linear mean of what went in: averages of points and triangles keep their colour (DESIGN 3, "never
// change the mean").
uint32_t encode_surface(const Surface& surface, uint32_t dither);
// Colour, openness and kind keep their bits: coding them anew would dither them once more. normal: not zero.
uint32_t replace_normal(uint32_t surface_bits, vec3 normal);
inline constexpr uint32_t k_leaf_bit = 1u << 31;
Surface decode_surface(uint32_t bits);

}  // namespace coppice
