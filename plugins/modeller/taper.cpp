#include "plugins/modeller/taper.h"

#include <algorithm>
#include <cmath>

#include "runtime/core/math.h"

namespace coppice::modeller {

float tapered_radius(float taper, float along_fraction, float base_radius_m, float length_m) {
    float z = std::clamp(along_fraction, 0.0f, 1.0f);
    float unit_taper = taper < 1.0f ? taper : taper < 2.0f ? 2.0f - taper : 0.0f;
    float cone_m = base_radius_m * (1.0f - unit_taper * z);
    if (taper <= 1.0f || cone_m <= 0.0f) return std::max(cone_m, 0.0f);
    float to_end_m = (1.0f - z) * length_m;  // W&P: Z2
    float depth = taper < 2.0f || to_end_m < cone_m ? 1.0f : taper - 2.0f;
    float from_bead_m = to_end_m;  // Z3
    if (taper >= 2.0f) {
        float beads = std::floor(to_end_m / (2.0f * cone_m) + 0.5f);
        from_bead_m = std::fabs(to_end_m - 2.0f * cone_m * beads);
    }
    if (taper < 2.0f && from_bead_m >= cone_m) return cone_m;
    float offset_m = from_bead_m - cone_m;
    float round_m = std::sqrt(std::max(cone_m * cone_m - offset_m * offset_m, 0.0f));
    return (1.0f - depth) * cone_m + depth * round_m;
}

float flare_factor(float flare, float along_fraction) {
    float y = std::max(1.0f - 8.0f * along_fraction, 0.0f);
    return 1.0f + flare * (portable_pow(100.0f, y) - 1.0f) / 99.0f;
}

}  // namespace coppice::modeller
