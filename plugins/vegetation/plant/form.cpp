#include "plugins/vegetation/plant/plant.h"

#include <algorithm>
#include <bit>

namespace coppice {

float DirectionForm::evaluate(vec3 d) const {
    float square = m[0] * d.x * d.x + m[1] * d.y * d.y + m[2] * d.z * d.z +
                   2.0f * (m[3] * d.x * d.y + m[4] * d.x * d.z + m[5] * d.y * d.z);
    return square > 0.0f ? std::sqrt(square) : 0.0f;
}

float gain_at(const PackedPart& part, float fill) {
    // Exponent and mantissa read as one number: the logarithm, with straight lines between powers of two.
    float logarithm = float(std::bit_cast<uint32_t>(std::max(fill, 1.0e-30f))) * 0x1p-23f - 127.0f;
    float level = std::clamp(logarithm + float(k_gain_levels - 1), 0.0f, float(k_gain_levels - 1));
    uint32_t low = std::min(uint32_t(level), k_gain_levels - 2);
    float share = level - float(low);
    return part.coverage_gain[low] * (1.0f - share) + part.coverage_gain[low + 1] * share;
}

}  // namespace coppice
