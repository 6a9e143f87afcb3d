#include "plugins/modeller/shape_ratio.h"

#include <algorithm>

#include "runtime/core/math.h"

namespace coppice::modeller {

float shape_ratio(Shape shape, float height_fraction) {
    float x = std::clamp(height_fraction, 0.0f, 1.0f);
    float flame = x <= 0.7f ? x / 0.7f : (1.0f - x) / 0.3f;
    switch (shape) {
        case Shape::conical:
            return 0.2f + 0.8f * x;
        case Shape::spherical:
            return 0.2f + 0.8f * portable_sin(k_pi * x);
        case Shape::hemispherical:
            return 0.2f + 0.8f * portable_sin(0.5f * k_pi * x);
        case Shape::cylindrical:
            return 1.0f;
        case Shape::tapered_cylindrical:
            return 0.5f + 0.5f * x;
        case Shape::flame:
            return flame;
        case Shape::inverse_conical:
            return 1.0f - 0.8f * x;
        case Shape::tend_flame:
            return 0.5f + 0.5f * flame;
    }
    return 1.0f;
}

float envelope_ratio(float height_fraction, float width_peak, float power_low, float power_high) {
    float x = height_fraction;
    if (!(x >= 0.0f && x <= 1.0f)) return 0.0f;
    float upper = 1.0f - width_peak;
    return x < upper ? portable_pow(x / upper, power_high) : portable_pow((1.0f - x) / width_peak, power_low);
}

}  // namespace coppice::modeller
