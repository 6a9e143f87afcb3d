#include "plugins/vegetation/plant/plant.h"

#include <algorithm>
#include <bit>

namespace coppice {

float DirectionForm::evaluate(vec3 d) const {
    float square = m[0] * d.x * d.x + m[1] * d.y * d.y + m[2] * d.z * d.z +
                   2.0f * (m[3] * d.x * d.y + m[4] * d.x * d.z + m[5] * d.y * d.z);
    return square > 0.0f ? std::sqrt(square) : 0.0f;
}

namespace {

// Between which of `count` levels, each `octaves` apart and the last at a fill of 1.
struct LevelShare {
    uint32_t low;
    float share;  // of the next
};
LevelShare level_of(float fill, uint32_t count, float octaves) {
    // Exponent and mantissa read as one number: the logarithm, with straight lines between powers of two.
    float logarithm = float(std::bit_cast<uint32_t>(std::max(fill, 1.0e-30f))) * 0x1p-23f - 127.0f;
    float level = std::clamp(logarithm / octaves + float(count - 1), 0.0f, float(count - 1));
    uint32_t low = std::min(uint32_t(level), count - 2);
    return {low, level - float(low)};
}

float mix(float a, float b, float share) { return a * (1.0f - share) + b * share; }

}  // namespace

float gain_at(const PackedPart& part, float fill) {
    const LevelShare at = level_of(fill, k_gain_levels, 1.0f);
    return mix(part.coverage_gain[at.low], part.coverage_gain[at.low + 1], at.share);
}

HeightGain height_gain_at(const PackedPart& part, float fill) {
    const LevelShare at = level_of(fill, k_gain_levels / 2, 2.0f);
    const HeightSteps &a = part.height_gain[at.low], &b = part.height_gain[at.low + 1];
    return {mix(float(a.second), float(b.second), at.share) / k_height_steps,
            mix(float(a.fourth), float(b.fourth), at.share) / k_height_steps};
}

HeightSteps round_height_gain(HeightGain gain) {
    auto round = [](float value) {
        const float steps = std::floor(value * k_height_steps + 0.5f);
        return int8_t(steps >= -127.0f ? std::min(steps, 127.0f) : -127.0f);
    };
    return {round(gain.second), round(gain.fourth)};
}

}  // namespace coppice
