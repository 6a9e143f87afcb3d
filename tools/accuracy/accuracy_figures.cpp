#include "tools/accuracy/accuracy_figures.h"

#include <algorithm>
#include <cmath>
#include <span>
#include "tools/accuracy/accuracy_summary.h"

namespace coppice {
namespace {

constexpr double FrameErrors::*k_judged[] = {&FrameErrors::rmse, &FrameErrors::flip, &FrameErrors::coverage,
                                             &FrameErrors::mean_color};

// How many times quicker than every triangle the default method is at its quickest setting whose errors are all no
// larger; 0 where it has no such setting.
double times_quicker(const AccuracyRecord& record, const std::vector<MethodPoint>& points,
                     std::span<double FrameErrors::*const> judged) {
    const MethodPoint* full = nullptr;
    for (const MethodPoint& point : points)
        if (point.method == record.full_method) full = &point;
    double best = 0.0;
    for (const MethodPoint& point : points) {
        if (!full || point.method != default_method(record) || !(point.frame_ms > 0.0)) continue;
        const bool as_near = std::all_of(judged.begin(), judged.end(), [&](double FrameErrors::*error) {
            return point.errors.*error <= full->errors.*error;
        });
        if (as_near) best = std::max(best, full->frame_ms / point.frame_ms);
    }
    return best;
}

// Frames a view rests until RMSE and FLIP are below those of every triangle; 0: never.
uint32_t frames_until_nearer(const AccuracyRecord& record, uint32_t view) {
    for (const AccuracyRecord::Resting& resting : record.resting)
        for (const AccuracySample& sample : record.samples)
            if (resting.view == view && sample.view == view && sample.method == record.full_method &&
                resting.errors.rmse < sample.errors.rmse && resting.errors.flip < sample.errors.flip)
                return resting.frames;
    return 0;
}

const AccuracyMethodRecord* find_method(const AccuracyRecord& record, const char* name) {
    for (const AccuracyMethodRecord& method : record.methods)
        if (method.name == name) return &method;
    return nullptr;
}

}  // namespace

std::vector<Figure> accuracy_figures(const AccuracyRecord& record) {
    std::vector<Figure> figures;
    const std::vector<MethodPoint> means = mean_points(record);
    figures.push_back({"quicker at no larger error", times_quicker(record, means, k_judged), "times", 50.0});
    double worst = INFINITY;
    for (uint32_t view = 0; view < record.views.size(); ++view)
        worst = std::min(worst, times_quicker(record, view_points(record, view), k_judged));
    if (std::isfinite(worst)) figures.push_back({"... in the worst view", worst, "times", 50.0});
    constexpr const char* k_names[] = {"... by RMSE alone", "... by FLIP alone", "... by coverage alone",
                                       "... by mean colour alone"};
    for (size_t i = 0; i < std::size(k_judged); ++i)
        figures.push_back({k_names[i], times_quicker(record, means, {&k_judged[i], 1}), "times", {}});

    const AccuracyMethodRecord& shown = record.methods[default_method(record)];
    const AccuracyMethodRecord* unblended = find_method(record, "hybrid, unblended");
    if (shown.pop_energy && unblended && unblended->pop_energy && *unblended->pop_energy > 0.0)
        figures.push_back({"pop energy, blended / unblended", *shown.pop_energy / *unblended->pop_energy, "",
                           0.1, Reach::at_most});
    if (!record.resting.empty()) {
        uint32_t frames = 0;
        for (uint32_t view = 0; view < record.views.size(); ++view) {
            const uint32_t needed = frames_until_nearer(record, view);
            frames = std::max(frames, needed > 0 ? needed : UINT32_MAX);
        }
        figures.push_back(
            {"frames at rest until nearer than full", double(frames), "worst view", 16.0, Reach::at_most});
    }
    if (record.duration_s > 0.0)
        figures.push_back({"bench, references apart", record.duration_s, "s", 900.0, Reach::at_most});
    return figures;
}

}  // namespace coppice
