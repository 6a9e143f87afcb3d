#include "plugins/vegetation/lod/rest.h"

#include <algorithm>
#include <cmath>

namespace coppice {
namespace {

// A frame at rest may take this much longer, squared; the first move is drawn after it.
constexpr float k_finest = 4.0f;
static_assert(k_finest * k_finest == 1.0f + float(k_frames_to_finest));

float fraction(double value) { return float(value - std::floor(value)); }

}  // namespace

RestingFrame resting_frame(uint32_t index, const FrameSettings& settings) {
    RestingFrame frame;
    frame.index = index;
    // Multiples of the plastic number's powers: any run of them is spread evenly over the square.
    frame.shift_px =
        vec2(fraction(0.5 + 0.7548776662466927 * index), fraction(0.5 + 0.5698402909980532 * index)) -
        vec2(0.5f);
    const float n = float(index);
    frame.new_share = mean_share(index);
    frame.sample_distance_px = settings.sample_distance_px / std::min(std::sqrt(1.0f + n), k_finest);
    // The more samples a pixel has the less its neighbours tell.
    frame.filter_radius_px = 1.0f + (settings.filter_radius_px - 1.0f) / std::sqrt(std::sqrt(1.0f + n));
    return frame;
}

}  // namespace coppice
