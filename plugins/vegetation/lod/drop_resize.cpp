#include "plugins/vegetation/lod/drop_resize.h"

#include <algorithm>
#include <cmath>
#include "runtime/core/math.h"

namespace coppice {

float remaining_share(float distance_m, const DropLaw& law) {
    if (!(distance_m > law.full_distance_m)) return 1.0f;
    const float near = law.full_distance_m / distance_m;
    return std::clamp(near * near, law.least_share, 1.0f);
}

float weighted_growth(float share, float weight) { return weight / std::sqrt(share) + (1.0f - weight); }

float tolerant_area_growth(float share, float optical_depth, float tolerance) {
    // Where next to nothing hides anything, -ln(1 - C) / D is 1 - tolerance, and the logarithm of a float is all rounding.
    constexpr float k_thin = 1e-3f;
    float kept = 1.0f - tolerance;
    if (tolerance > 0.0f && optical_depth > k_thin) {
        const float seen_through = tolerance + (1.0f - tolerance) * portable_exp(-optical_depth);  // 1 - C
        kept = -portable_log(seen_through) / optical_depth;
    }
    return std::max(kept / share, 1.0f);
}

float remaining_area(float place, float share, float band) {
    const float half = std::min(band * share, 1.0f - share);
    if (!(half > 0.0f)) return place < share ? 1.0f : 0.0f;
    return std::clamp((share + half - place) / (2.0f * half), 0.0f, 1.0f);
}

float remaining_contrast(float share) { return std::sqrt(share); }

float points_from_m(float area_m2, float least_count, float focal_px, float sample_distance_px) {
    return focal_px * std::sqrt(0.5f * area_m2 / least_count) / sample_distance_px;
}

}  // namespace coppice
