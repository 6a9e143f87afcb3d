// How far a map may be warped, by the angle between light and view. In the light's plane the view's direction turns the
// faster the smaller that angle is, and the warp with it: before it can be seen to turn, the map has become uniform.
#pragma once
#include <algorithm>
#include "plugins/vegetation/shadow/fit_plane_map.h"

namespace coppice {

// Sines of the angle: below the first no warp, above the second all of it.
inline constexpr double k_uniform_sine = 0.02;

// In [0, 1], smooth.
inline double warped_share(double sine, double whole_sine) {
    const double share = std::clamp((sine - k_uniform_sine) / (whole_sine - k_uniform_sine), 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

}  // namespace coppice
