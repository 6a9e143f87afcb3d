// Gradient noise on the plane, from integer hashes: the same bits on every compiler, machine and thread.
#pragma once
#include <cstdint>
#include "runtime/core/hash.h"
#include "runtime/core/math.h"

namespace coppice {

// In (-1, 1), mean 0, one hill or hollow a unit square; zero at the corners of the unit grid.
inline float gradient_noise(double x, double z, uint32_t seed) {
    double x_floor = std::floor(x), z_floor = std::floor(z);
    uint32_t column = uint32_t(int64_t(x_floor)), row = uint32_t(int64_t(z_floor));
    float u = float(x - x_floor), v = float(z - z_floor);
    auto corner = [&](uint32_t i, uint32_t j) {
        uint32_t bits = mix_bits(column + i + mix_bits(row + j + mix_bits(seed)));
        float gx = float(bits & 0xffffu) * (2.0f / 65535.0f) - 1.0f;
        float gz = float(bits >> 16) * (2.0f / 65535.0f) - 1.0f;
        return gx * (u - float(i)) + gz * (v - float(j));
    };
    auto fade = [](float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); };
    float a = fade(u), b = fade(v);
    float near = corner(0, 0) + a * (corner(1, 0) - corner(0, 0));
    float far = corner(0, 1) + a * (corner(1, 1) - corner(0, 1));
    return near + b * (far - near);
}

// Sum of octaves, each half as long and `gain` as strong; divided by the sum of the strengths and brought to
// a standard deviation of about 0.25. x, z in wavelengths of the first octave.
inline float fractal_noise(double x, double z, uint32_t octaves, float gain, uint32_t seed) {
    float sum = 0.0f, strength = 1.0f, total = 0.0f;
    for (uint32_t octave = 0; octave < octaves; ++octave) {
        sum += strength * gradient_noise(x, z, seed + octave * 0x9e3779b9u);
        total += strength * strength;
        strength *= gain;
        // Turned by about 37 degrees, so that the grids of the octaves do not show through together.
        double turned = 1.6 * x - 1.2 * z;
        z = 1.2 * x + 1.6 * z + 17.3;
        x = turned;
    }
    return sum / std::sqrt(total) * 1.15f;
}

inline float smooth_step(float low, float high, float x) {
    float t = high > low ? glm::clamp((x - low) / (high - low), 0.0f, 1.0f) : (x < low ? 0.0f : 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

}  // namespace coppice
