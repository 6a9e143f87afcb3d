#include "plugins/vegetation/cook/steer_coverage.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr double k_step = 0.85;  // share of the leaves from one count to the next
// Flatness, and the share of the area that faces a direction, over coverage that is too much: of the last count, and of all.
// Found on four crowns of 8,000 to 114,000 leaves; twice the first swings.
constexpr float k_flatness_now = 15.0f, k_flatness_ever = 7.0f, k_lean_now = 10.0f, k_lean_ever = 2.7f;
constexpr float k_flattest = 1.0f, k_least_flat = 0.2f;
constexpr float k_area_for_flatness = 0.7f;  // covers as much less as flatness does

}  // namespace

CoverageSteering::CoverageSteering(std::span<const Leaf> crown, float least_area)
    : coverage_(crown), least_area_(least_area), next_count_(k_step * double(crown.size())) {}

void CoverageSteering::steer(std::span<const Leaf> leaves) {
    next_count_ *= k_step;
    const CoverageExcess now = coverage_.measure(leaves);
    sum_.mean += now.mean;
    const float wished = JoinWish{}.flatness - k_flatness_now * now.mean - k_flatness_ever * sum_.mean;
    wish_.flatness = std::clamp(wished, k_least_flat, k_flattest);
    wish_.area = std::clamp(1.0f + k_area_for_flatness * (wished - k_least_flat), least_area_, 1.0f);
    // What neither can do any more is not asked for later.
    const bool at_least = wished < k_least_flat && wish_.area == least_area_;
    if (wished > k_flattest || at_least) sum_.mean -= now.mean;
    for (size_t k = 0; k < 6; ++k) {
        sum_.by_direction[k] += now.by_direction[k];
        wish_.lean[k] = -k_lean_now * now.by_direction[k] - k_lean_ever * sum_.by_direction[k];
    }
}

}  // namespace coppice
