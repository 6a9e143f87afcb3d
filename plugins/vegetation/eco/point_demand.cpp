#include "plugins/vegetation/eco/point_demand.h"

#include <algorithm>
#include "plugins/vegetation/plant/line_points.h"

namespace coppice {
PointDemand::PointDemand(const PackedPart& part, float model_importance)
    : part_(&part), lines_(part.kind == PackedPartKind::lines) {
    const double importance = double(part.importance) * double(model_importance);
    if (importance > 0.0) importance_ = std::clamp(importance, k_least_importance, k_most_importance);
    const double area_m2 = double(mean_projected_area_m2(part));
    if (part.triangle_count == 0 || !(area_m2 > 0.0) || !std::isfinite(area_m2)) return;
    area_m2_ = area_m2;
    if (lines_) {
        const double length_m = double(mean_projected_length_m(part));
        if (!(length_m > 0.0) || !std::isfinite(length_m)) return;
        stored_count_ = line_point_count(part);
        unit_ = length_m / area_m2 * (length_m / area_m2);
    } else {
        stored_count_ = part.point_count;
        unit_ = std::max(double(part.point_count), 1.0) / area_m2;
    }
    double most = 0.0;
    for (size_t level = 0; level < k_gain_levels; ++level) {
        most = std::max(
            most, fill_power(double(fill_at_level(uint32_t(level)))) * double(part.coverage_gain[level]));
        reach_[level] = most;
    }
}

float PointDemand::fill(double density) const {
    const double power = density / unit_;
    return float(lines_ ? std::sqrt(power) : power);
}

double PointDemand::gain(double density) const {
    return stored_count_ == 0 ? 1.0 : double(gain_at(*part_, fill(density)));
}

HeightGain PointDemand::height_gain(double density) const {
    return stored_count_ == 0 ? HeightGain{} : height_gain_at(*part_, fill(density));
}

double PointDemand::density(double count) const {
    const double asked = count / (unit_ * area_m2_ * importance_);
    const size_t level = size_t(std::lower_bound(reach_.begin(), reach_.end(), asked) - reach_.begin());
    const auto& gains = part_->coverage_gain;
    if (level == 0) return unit_ * (asked / double(gains.front()));
    if (level == k_gain_levels) return unit_ * std::max(asked / double(gains.back()), 1.0);
    // Between two levels the gain is straight in fill (gain_at): asked = u^power (low + step (u - 1)), u in [1, 2].
    // Newton's steps from the chord; three are exact to a double's rounding where gains differ by a quarter.
    const double low = double(gains[level - 1]), step = double(gains[level]) - low;
    const double begin = fill_power(double(fill_at_level(uint32_t(level - 1)))), target = asked / begin;
    double u = 1.0 + (target - low) / (fill_power(2.0) * (low + step) - low);
    for (int i = 0; i < 5; ++i) {
        u = std::clamp(u == u ? u : 2.0, 1.0, 2.0);
        const double here = low + step * (u - 1.0);
        const double slope = (lines_ ? 2.0 * u : 1.0) * here + fill_power(u) * step;
        if (!(slope > 0.0)) break;
        u -= (fill_power(u) * here - target) / slope;
    }
    return unit_ * (begin * fill_power(std::clamp(u, 1.0, 2.0)));
}

}  // namespace coppice
