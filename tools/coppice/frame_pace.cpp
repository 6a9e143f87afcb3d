#include "tools/coppice/frame_pace.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

double rate_hz(double ms) { return ms > 0.0 ? 1000.0 / ms : 0.0; }

uint32_t count_hitches(std::span<const double> frames_ms) {
    uint32_t hitches = 0;
    for (size_t i = 0; i < frames_ms.size(); ++i) {
        const size_t first = i - std::min(i, k_hitch_frames),
                     last = std::min(i + k_hitch_frames + 1, frames_ms.size());
        const double usual_ms = median({frames_ms.begin() + long(first), frames_ms.begin() + long(last)});
        hitches += frames_ms[i] > k_hitch_factor * usual_ms && frames_ms[i] >= usual_ms + k_hitch_ms;
    }
    return hitches;
}

}  // namespace

FramePace measure_pace(std::span<const double> frames_ms) {
    if (frames_ms.empty()) return {};
    std::vector<double> slowest(frames_ms.begin(), frames_ms.end());
    FramePace pace;
    pace.mean_ms = std::accumulate(slowest.begin(), slowest.end(), 0.0) / double(slowest.size());
    pace.p50_ms = median(slowest);
    pace.p95_ms = quantile(slowest, 0.95);
    pace.p99_ms = quantile(slowest, 0.99);
    pace.low_1_percent_as_p99_hz = rate_hz(pace.p99_ms);
    std::sort(slowest.begin(), slowest.end(), std::greater<>());
    slowest.resize((slowest.size() + 99) / 100);
    pace.low_1_percent_as_mean_hz =
        rate_hz(std::accumulate(slowest.begin(), slowest.end(), 0.0) / double(slowest.size()));
    pace.hitches = count_hitches(frames_ms);
    return pace;
}

OverBudget measure_over_budget(std::span<const double> frames_ms, double budget_ms) {
    OverBudget over;
    for (const double ms : frames_ms) {
        if (!(ms > budget_ms)) continue;
        ++over.frames;
        over.ms += ms - budget_ms;
    }
    return over;
}

}  // namespace coppice
