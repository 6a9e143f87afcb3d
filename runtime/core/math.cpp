#include "runtime/core/math.h"

#include <bit>

namespace coppice {
namespace {

// Polynomials on [-pi/4, pi/4]; coefficients are the Taylor ones, whose error there is below float's.
float sin_core(float x) {
    float z = x * x;
    return x + x * z * (-1.6666667e-1f + z * (8.3333333e-3f + z * (-1.9841270e-4f + z * 2.7557319e-6f)));
}
float cos_core(float x) {
    float z = x * x;
    return 1.0f +
           z * (-0.5f + z * (4.1666667e-2f + z * (-1.3888889e-3f + z * (2.4801587e-5f - z * 2.7557319e-7f))));
}

// Sine of quadrant * pi/2 + remainder.
float quadrant_sin(float angle_rad, int quadrant_shift) {
    if (!std::isfinite(angle_rad)) return quadrant_shift ? 1.0f : 0.0f;
    // Reduction in double keeps the remainder exact to float precision up to 1e4 and beyond.
    double turns = double(angle_rad) * 0.63661977236758134308;
    double nearest = turns < 0.0 ? double(int64_t(turns - 0.5)) : double(int64_t(turns + 0.5));
    if (!(nearest > -9.0e15 && nearest < 9.0e15)) return quadrant_shift ? 1.0f : 0.0f;
    float remainder = float((turns - nearest) * 1.57079632679489661923);
    switch ((int64_t(nearest) + quadrant_shift) & 3) {
        case 0:
            return sin_core(remainder);
        case 1:
            return cos_core(remainder);
        case 2:
            return -sin_core(remainder);
        default:
            return -cos_core(remainder);
    }
}

}  // namespace

float portable_sin(float angle_rad) {
    if (!(std::fabs(angle_rad) < 1.0e9f)) return 0.0f;
    return quadrant_sin(angle_rad, 0);
}
float portable_cos(float angle_rad) {
    if (!(std::fabs(angle_rad) < 1.0e9f)) return 1.0f;
    return quadrant_sin(angle_rad, 1);
}

float portable_exp2(float x) {
    if (!(x > -126.0f)) return x == x ? 1.1754944e-38f : 1.0f;
    if (x > 126.0f) return 8.5070592e37f;
    float whole = float(int32_t(x < 0.0f ? x - 0.5f : x + 0.5f));
    double f = double(x - whole) * 0.69314718055994530942;
    double p =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6 + f * (1.0 / 24 + f * (1.0 / 120 + f * (1.0 / 720))))));
    return float(p) * std::bit_cast<float>(uint32_t(int32_t(whole) + 127) << 23);
}

float portable_log2(float x) {
    if (!(x > 1.1754944e-38f)) return -126.0f;
    if (x > 3.4e38f) return 128.0f;
    uint32_t bits = std::bit_cast<uint32_t>(x);
    int32_t exponent = int32_t(bits >> 23) - 127;
    float mantissa = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u);
    if (mantissa > 1.41421356f) {
        mantissa *= 0.5f;
        ++exponent;
    }
    // log((1 + s) / (1 - s)) = 2 (s + s^3/3 + ...), |s| < 0.172
    double s = (double(mantissa) - 1.0) / (double(mantissa) + 1.0), z = s * s;
    double log_e =
        2.0 * s * (1.0 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9 + z * (1.0 / 11))))));
    return float(double(exponent) + log_e * 1.44269504088896340736);
}

float portable_pow(float base, float exponent) {
    if (exponent == 0.0f) return 1.0f;
    if (!(base > 0.0f)) return 0.0f;
    return portable_exp2(exponent * portable_log2(base));
}

float portable_atan2(float y, float x) {
    float ax = std::fabs(x), ay = std::fabs(y);
    if (!(ax + ay > 0.0f)) return 0.0f;
    bool steep = ay > ax;
    double t = steep ? double(ax) / double(ay) : double(ay) / double(ax);  // [0, 1]
    // atan(t) = pi/8 + atan((t - a) / (1 + a t)), a = tan(pi/8), where t is above half of it
    double base = 0.0;
    if (t > 0.2) {
        constexpr double a = 0.41421356237309504880;
        base = 0.39269908169872415481;
        t = (t - a) / (1.0 + a * t);
    }
    if (t > 0.2) {
        constexpr double a = 0.19891236737965800691;  // tan(pi/16)
        base += 0.19634954084936207740;
        t = (t - a) / (1.0 + a * t);
    }
    double z = t * t;
    double angle = base + t * (1.0 - z * (1.0 / 3 - z * (1.0 / 5 - z * (1.0 / 7 - z * (1.0 / 9 - z / 11)))));
    if (steep) angle = 1.57079632679489661923 - angle;
    if (x < 0.0f) angle = 3.14159265358979323846 - angle;
    return float(y < 0.0f ? -angle : angle);
}

float portable_acos(float x) {
    if (x >= 1.0f) return 0.0f;
    if (x <= -1.0f) return k_pi;
    if (!(x == x)) return 0.0f;
    return portable_atan2(std::sqrt((1.0f - x) * (1.0f + x)), x);
}

vec3 normalize_or(vec3 v, vec3 otherwise) {
    float largest = std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z)));
    if (!(largest > 0.0f) || !std::isfinite(largest)) return otherwise;
    v = v * (1.0f / largest);  // so that the squares neither overflow nor vanish
    if (!is_finite(v)) return otherwise;
    return v * (1.0f / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z));
}

vec3 perpendicular_to(vec3 n) {
    vec3 axis = std::fabs(n.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
    return normalize_or(glm::cross(n, axis), vec3(0, 0, 1));
}

vec3 rotate_about(vec3 v, vec3 axis, float angle_rad) {
    float s = portable_sin(angle_rad), c = portable_cos(angle_rad);
    return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1.0f - c));
}

float srgb_to_linear(float s) {
    if (!(s > 0.0f)) return 0.0f;
    if (s >= 1.0f) return 1.0f;
    return s <= 0.04045f ? s / 12.92f : portable_pow((s + 0.055f) / 1.055f, 2.4f);
}
float linear_to_srgb(float l) {
    if (!(l > 0.0f)) return 0.0f;
    if (l >= 1.0f) return 1.0f;
    return l <= 0.0031308f ? l * 12.92f : 1.055f * portable_pow(l, 1.0f / 2.4f) - 0.055f;
}

}  // namespace coppice
