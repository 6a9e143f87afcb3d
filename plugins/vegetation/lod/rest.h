// A view at rest: as long as nothing moves each frame samples another place of the pixel and draws other points of the
// plants, and the mean of the frames is shown. Its noise falls with every frame; and because there is time, d' falls
// too, so that what is averaged comes nearer to the full geometry.
#pragma once
#include <cstdint>
#include "plugins/vegetation/lod/settings.h"
#include "runtime/core/math.h"

namespace coppice {

// d' falls up to here.
inline constexpr uint32_t k_frames_to_finest = 15;
// Of one more frame in the mean of `averaged` before it, weights 1, 2, 3 ...: the later frames are the finer ones.
inline float mean_share(uint32_t averaged) { return 2.0f / (float(averaged) + 2.0f); }

struct RestingFrame {
    vec2 shift_px{0.0f};     // where in the pixel the frame is sampled, from its centre; |shift| <= 1/2
    float new_share = 1.0f;  // of this frame in the mean
    float sample_distance_px = 1.0f;
    float filter_radius_px = 1.0f;
    uint32_t index = 0;  // turns over which points and lines are drawn; 0: the first ones
};

// index: frames that the view has rested, 0 the first. Frame 0 is the frame of a moving view.
RestingFrame resting_frame(uint32_t index, const FrameSettings& settings);

}  // namespace coppice
