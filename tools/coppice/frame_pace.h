// How evenly frames came: the figures players feel, in the meanings that are usual for them.
#pragma once
#include <cstdint>
#include <span>

namespace coppice {

struct FramePace {
    double mean_ms = 0.0, p50_ms = 0.0, p95_ms = 0.0, p99_ms = 0.0;
    // "1 % low" means either; they differ where the slowest frames are few and long.
    double low_1_percent_as_p99_hz = 0.0;  // the p99 frame time as a rate
    double low_1_percent_as_mean_hz =
        0.0;  // the mean of the slowest 1 % of the frames (at least one) as a rate
    uint32_t hitches = 0;
};

// A hitch is a frame longer than twice the median of the frames around it and at least k_hitch_ms longer: a step that is
// seen, in a flight that is smooth there. Around it are the k_hitch_frames before and after, as far as there are any.
inline constexpr double k_hitch_factor = 2.0, k_hitch_ms = 4.0;
inline constexpr size_t k_hitch_frames = 15;

// All 0 where there is no frame.
FramePace measure_pace(std::span<const double> frames_ms);

struct OverBudget {
    uint32_t frames = 0;  // longer than the budget
    double ms = 0.0;      // by which they were, together
};
OverBudget measure_over_budget(std::span<const double> frames_ms, double budget_ms);

}  // namespace coppice
