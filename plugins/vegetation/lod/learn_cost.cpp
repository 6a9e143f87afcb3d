#include "plugins/vegetation/lod/learn_cost.h"

#include <algorithm>
#include <cmath>

namespace coppice {
namespace {

// Measured with two cores of lavapipe, at 795x700 with plants of small triangles. Frames soon overrule them; where none
// tells two kinds apart, their ratio stays.
constexpr PrimitiveCosts k_usual{8.0, 25.0, 40.0, 12.0, 48.0};
constexpr double k_ns_in_ms = 1.0e-6;

constexpr double k_remembered = 0.995;     // of what was known in a frame's direction: the last 200 frames
constexpr double k_prior = 0.02;           // frames' worth of trust in the usual ratios
constexpr double k_outlier_spreads = 3.0;  // from here on a frame's pull grows no more
constexpr double k_least_spread = 0.005, k_most_spread = 0.5;
constexpr double k_least_scale = 1.0e-6, k_most_scale = 1.0e6;
constexpr double k_least_of_scale = 1.0e-3,
                 k_most_of_scale = 1.0e3;  // above zero, so that shares stay bounded

// x with a x = b for a symmetric positive definite a, by Cholesky.
template <size_t N>
std::array<double, N> solve(std::array<std::array<double, N>, N> a, std::array<double, N> b) {
    for (size_t j = 0; j < N; ++j) {
        for (size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        a[j][j] = std::sqrt(std::max(a[j][j], 1.0e-12));
        for (size_t i = j + 1; i < N; ++i) {
            for (size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (size_t i = N; i-- > 0;) {
        for (size_t k = i + 1; k < N; ++k) b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
    return b;
}

}  // namespace

double PrimitiveCosts::ms_of(const PrimitiveCounts& counts) const {
    return frame_ms + (triangle_ns * double(counts.triangles) + line_ns * double(counts.lines) +
                       point_ns * double(counts.points) + leaf_ns * double(counts.leaves)) *
                          k_ns_in_ms;
}

PrimitiveCosts LearnedCost::costs() const {
    return {k_usual.frame_ms * factors_[0], k_usual.triangle_ns * factors_[1], k_usual.line_ns * factors_[2],
            k_usual.point_ns * factors_[3], k_usual.leaf_ns * factors_[4]};
}

double LearnedCost::expected_ms(const Terms& usual_ms) const {
    double sum = 0.0;
    for (int i = 0; i < k_terms; ++i) sum += usual_ms[i] * factors_[i];
    return sum;
}

void LearnedCost::scale_to(double ratio) {
    const double before = scale_;
    scale_ = std::clamp(before * ratio, k_least_scale, k_most_scale);
    for (double& factor : factors_) factor *= scale_ / before;
}

void LearnedCost::learn(const PrimitiveCounts& counts, double measured_ms) {
    if (!std::isfinite(measured_ms) || !(measured_ms > 0.0)) return;
    const Terms usual_ms{k_usual.frame_ms, k_usual.triangle_ns * double(counts.triangles) * k_ns_in_ms,
                         k_usual.line_ns * double(counts.lines) * k_ns_in_ms,
                         k_usual.point_ns * double(counts.points) * k_ns_in_ms,
                         k_usual.leaf_ns * double(counts.leaves) * k_ns_in_ms};
    const double expected = expected_ms(usual_ms);

    // At first, and after the machine has changed, all costs are scaled alike: five frames tell no kinds apart, and the
    // first ones may be hitches, which a median bears.
    if (first_frames_ < k_first_frames) {
        const double before = first_frames_ > 0 ? first_ratios_[size_t(first_frames_ - 1) / 2] : 1.0;
        const double ratio = std::clamp(measured_ms / expected * before, k_least_scale,
                                        k_most_scale);  // of the costs at the start
        auto end = first_ratios_.begin() + first_frames_++;
        *end = ratio;
        std::sort(first_ratios_.begin(), end + 1);
        scale_to(first_ratios_[size_t(first_frames_ - 1) / 2] / before);
        information_ = {};
        for (int i = 0; i < k_terms; ++i) information_[i][i] = k_prior;
        return;
    }

    // Half the time is as far off as twice the time.
    const double error = measured_ms / expected - 1.0;
    const double size = error < 0.0 ? expected / measured_ms - 1.0 : error;
    const double limit = k_outlier_spreads * spread_;
    const bool outlier = size > limit;
    run_ = !outlier ? 0 : error > 0.0 ? std::max(run_, 0) + 1 : std::min(run_, 0) - 1;
    if (std::abs(run_) >= k_lasting_frames) {
        run_ = 0;
        first_frames_ = 0;
        return;
    }
    spread_ = std::clamp(spread_ + (std::min(size, limit) - spread_) / 32.0, k_least_spread, k_most_spread);

    Terms share;
    for (int i = 0; i < k_terms; ++i) share[i] = usual_ms[i] * scale_ / expected;
    update(share, error, outlier ? limit / size : 1.0);
}

void LearnedCost::update(const Terms& share, double error, double weight) {
    Terms known{};  // information times share
    double in_direction = 0.0;
    for (int i = 0; i < k_terms; ++i) {
        for (int j = 0; j < k_terms; ++j) known[i] += information_[i][j] * share[j];
        in_direction += known[i] * share[i];
    }
    const double forgotten = in_direction > 0.0 ? (1.0 - k_remembered) * weight / in_direction : 0.0;
    for (int i = 0; i < k_terms; ++i)
        for (int j = 0; j < k_terms; ++j)
            information_[i][j] += weight * share[i] * share[j] - forgotten * known[i] * known[j];
    const Terms step = solve(information_, share);
    for (int i = 0; i < k_terms; ++i)
        factors_[i] = scale_ * std::clamp(factors_[i] / scale_ + weight * error * step[i], k_least_of_scale,
                                          k_most_of_scale);
}

uint64_t LearnedCost::vertex_budget_for(double budget_ms, const PrimitiveCounts& mix) const {
    constexpr double k_most_vertices = 0x1p40;
    const PrimitiveCosts cost = costs();
    const double for_plants_ns = (budget_ms - cost.frame_ms) / k_ns_in_ms;
    if (!(for_plants_ns > 0.0)) return 0;
    const double vertices = 3.0 * double(mix.triangles) + 2.0 * double(mix.lines) + double(mix.points) +
                            4.0 * double(mix.leaves);
    double vertex_ns =
        std::max({cost.triangle_ns / 3.0, cost.line_ns / 2.0, cost.point_ns, cost.leaf_ns / 4.0});
    if (vertices > 0.0)
        vertex_ns = (cost.triangle_ns * double(mix.triangles) + cost.line_ns * double(mix.lines) +
                     cost.point_ns * double(mix.points) + cost.leaf_ns * double(mix.leaves)) /
                    vertices;
    return uint64_t(std::min(for_plants_ns / vertex_ns, k_most_vertices));
}

}  // namespace coppice
