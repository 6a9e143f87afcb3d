// The outline of a crown: W&P's shape ratio, the length of a branch by its height in the crown.
// Source: Weber and Penn 1995, section 4.
#pragma once
#include <cstdint>

namespace coppice::modeller {

enum class Shape : uint32_t {
    conical,
    spherical,
    hemispherical,
    cylindrical,
    tapered_cylindrical,
    flame,
    inverse_conical,
    tend_flame,
};

// height_fraction: 0 at the crown's top, 1 at its base; clamped.
float shape_ratio(Shape shape, float height_fraction);

// W&P's pruning envelope: its half width at that place, relative to its greatest. peak in (0, 1): where it is
// widest, counted from the base.
float envelope_ratio(float height_fraction, float width_peak, float power_low, float power_high);

}  // namespace coppice::modeller
