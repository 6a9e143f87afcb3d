// How the colours of a population's plants differ, so that a wood is no copy of one tree. A plant's tint follows from its
// seed, all that stands for the plant has it, and in the mean over plants every colour stays what it is in linear light.
// A tint t turns and stretches colours about grey: c -> b (m + p (c - m) + q k x c), with m the mean of c's channels and k the
// unit grey. It is linear in c, and b, p and q are 1, 1 and 0 in the mean.
#pragma once
#include <compare>
#include <cstdint>
#include "plugins/vegetation/components.h"

namespace coppice {

class JsonObject;

// At most, either way; uniform but for the hue, whose half angle's tangent is.
struct ColorVariation {
    float brightness = 0.0f;  // share, [0, 0.9]
    float hue_deg = 0.0f;     // [0, 45]
    float saturation = 0.0f;  // share, [0, 0.7]

    bool any() const { return brightness > 0.0f || hue_deg > 0.0f || saturation > 0.0f; }
    auto operator<=>(const ColorVariation&) const = default;
};

// {"brightness": 0.15, "hue_deg": 8, "saturation": 0.2}, each of which may be missing. Faults go to the document.
ColorVariation read_color_variation(JsonObject& object);

// Of a plant: 24 bits, b - 1 and p - 1 in steps of 1/128, q in steps of 1/64, a signed byte each. 0 changes nothing.
class ColorTints {
  public:
    ColorTints() = default;
    explicit ColorTints(const ColorVariation& variation);
    bool any() const { return any_; }
    uint32_t tint_of(uint32_t seed) const;

  private:
    bool any_ = false;
    float brightness_ = 0.0f, saturation_ = 0.0f;
    float half_turn_ = 0.0f;  // tangent of half the largest turn
    float gain_ = 1.0f;       // what turning takes of a colour's distance from grey
};

// Cut off at 0 and 1.
vec3 tint_color(uint32_t tint, vec3 color_linear);
// The word's colour, rounded up or down by `dither` (any well mixed bits) so that the mean over many is the linear mean.
uint32_t tint_surface(uint32_t tint, uint32_t surface_bits, uint32_t dither);

}  // namespace coppice
