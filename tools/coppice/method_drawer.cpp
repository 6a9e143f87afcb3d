#include "tools/coppice/method_drawer.h"

#include "plugins/vegetation/draw/work_list.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

constexpr double k_timed_ms = 250.0;  // a median of at least so much
constexpr uint32_t k_timed_frames = 5, k_timed_frames_most = 25;
constexpr double k_long_frame_ms =
    1000.0;  // such frames are timed once or twice: their noise is small beside them
constexpr uint32_t k_growth_tries = 6;  // the work list at least doubles each time

}  // namespace

Status MethodDrawer::show(const DrawnFrame& drawn) {
    if (shown_ == drawn.scene && shown_revision_ == drawn.revision) return {};
    COPPICE_CHECK(host_.vegetation->set_scene(drawn.scene->scene, drawn.scene->plants));
    shown_ = drawn.scene;
    shown_revision_ = drawn.revision;
    geometry_bytes_ = 0;
    for (const Plant& plant : drawn.scene->plants)
        geometry_bytes_ += plant.triangle_vertices.size_bytes() + plant.points.size_bytes() +
                           plant.point_owners.size_bytes() + plant.line_vertices.size_bytes() +
                           plant.leaves.size_bytes();
    return {};
}

// A frame whose work list did not fit is drawn again, in a longer one.
Result<PlayHost::FrameTimes> MethodDrawer::draw_whole(const Camera& camera, const FrameSettings& settings) {
    for (uint32_t tries = 0;; ++tries) {
        COPPICE_TRY(const PlayHost::FrameTimes times, host_.draw_frame(camera, settings));
        const FrameReport& report = host_.vegetation->report();
        if ((report.dropped_entries == 0 && report.dropped_triangles == 0) || tries == k_growth_tries)
            return times;
    }
}

Result<MethodDrawer::Timing> MethodDrawer::time(const DrawnFrame& drawn, const Camera& camera) {
    COPPICE_CHECK(show(drawn));
    FrameSettings settings = drawn.settings;
    settings.accumulate_limit = 0;
    COPPICE_TRY(PlayHost::FrameTimes times, draw_whole(camera, settings));
    if (times.wall_ms < k_long_frame_ms) {
        // Both slots' lists have grown, and nothing is compiled any more.
        COPPICE_TRY(times, draw_whole(camera, settings));
    }
    std::vector<double> frames_ms;
    double sum_ms = 0.0;
    const uint32_t least = times.wall_ms < k_long_frame_ms ? k_timed_frames : 1;
    while (frames_ms.size() < least || (sum_ms < k_timed_ms && frames_ms.size() < k_timed_frames_most)) {
        COPPICE_TRY(times, host_.draw_frame(camera, settings));
        frames_ms.push_back(times.wall_ms);
        sum_ms += times.wall_ms;
    }
    const FrameReport& report = host_.vegetation->report();
    return Timing{median(frames_ms),
                  report.triangles,
                  report.lines,
                  report.points,
                  geometry_bytes_,
                  report.plants_visible * sizeof(WorkInstance) + report.work_entries * sizeof(WorkEntry)};
}

Result<FloatPicture> MethodDrawer::draw(FrameSettings settings, const Camera& camera, uint32_t frames) {
    for (uint32_t tries = 0; tries < k_growth_tries; ++tries) {
        bool whole = true;
        settings.accumulate_limit = 0;  // forgets the frames before
        if (tries > 0) COPPICE_CHECK(draw_whole(camera, settings));
        settings.accumulate_limit = frames;
        for (uint32_t i = 0; i < frames && whole; ++i) {
            COPPICE_CHECK(host_.draw_frame(camera, settings));
            whole = host_.vegetation->report().dropped_entries == 0;
        }
        if (whole) break;
    }
    COPPICE_TRY(const Picture shown, host_.read_picture());
    return decode_srgb(shown);
}

Result<FloatPicture> MethodDrawer::picture(const DrawnFrame& drawn, const Camera& camera, uint32_t frames) {
    COPPICE_CHECK(show(drawn));
    return draw(drawn.settings, camera, frames);
}

Result<MeasuredFrame> MethodDrawer::measure(const DrawnFrame& drawn, const Camera& camera, uint32_t frames) {
    MeasuredFrame frame;
    COPPICE_TRY(frame.display, picture(drawn, camera, frames));
    FrameSettings mask = drawn.settings;
    mask.view = RepresentationView::coverage;
    COPPICE_TRY(const FloatPicture white, draw(mask, camera, frames));
    frame.coverage.resize(white.rgb.size() / 3);
    for (size_t i = 0; i < frame.coverage.size(); ++i) frame.coverage[i] = white.rgb[3 * i];
    return frame;
}

}  // namespace coppice
