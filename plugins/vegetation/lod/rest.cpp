#include "plugins/vegetation/lod/rest.h"

#include <algorithm>
#include <cmath>

namespace coppice {
namespace {

float fraction(double value) { return float(value - std::floor(value)); }

}  // namespace

RestingFrame resting_frame(uint32_t index, const FrameSettings& settings) {
    RestingFrame frame;
    frame.index = index;
    // Multiples of the plastic number's powers: any run of them is spread evenly over the square.
    frame.shift_px =
        vec2(fraction(0.5 + 0.7548776662466927 * index), fraction(0.5 + 0.5698402909980532 * index)) -
        vec2(0.5f);
    frame.new_share = 1.0f / float(index + 1);
    frame.sample_distance_px = settings.sample_distance_px;
    // Many samples a pixel need no neighbours.
    frame.filter_radius_px = 1.0f + (settings.filter_radius_px - 1.0f) / float(index + 1);
    return frame;
}

}  // namespace coppice
