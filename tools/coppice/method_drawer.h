// Draws what a method asks for on a PlayHost: times frames, and takes them as linear light with their mask of plants.
#pragma once
#include "tools/accuracy/method.h"
#include "tools/accuracy/metrics.h"
#include "tools/coppice/play_host.h"

namespace coppice {

class MethodDrawer {
  public:
    explicit MethodDrawer(PlayHost& host) : host_(host) {}

    struct Timing {
        double frame_ms;  // median of frames that stand alone, from start to complete picture
        uint64_t triangles, lines, points, geometry_bytes, list_bytes;
    };
    // After frames that warm it up; more frames are timed where they are short.
    Result<Timing> time(const DrawnFrame& drawn, const Camera& camera);

    // Display light of one frame, or of several, each at another place of the pixel.
    Result<FloatPicture> picture(const DrawnFrame& drawn, const Camera& camera, uint32_t frames);
    Result<MeasuredFrame> measure(const DrawnFrame& drawn, const Camera& camera, uint32_t frames);

  private:
    Status show(const DrawnFrame& drawn);
    Result<FloatPicture> draw(FrameSettings settings, const Camera& camera, uint32_t frames);
    Result<PlayHost::FrameTimes> draw_whole(const Camera& camera, const FrameSettings& settings);

    PlayHost& host_;
    const MethodScene* shown_ = nullptr;
    uint64_t shown_revision_ = 0;
    uint64_t geometry_bytes_ = 0;
};

}  // namespace coppice
