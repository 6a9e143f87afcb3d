// Gradient noise on the plane, from integer hashes: the same bits on every compiler, machine and thread.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include "runtime/core/hash.h"
#include "runtime/core/math.h"

namespace coppice {

// In (-1, 1), mean 0, one hill or hollow a unit square; zero at the corners of the unit grid.
// corner_bits(column, row): random bits of a corner.
template <typename CornerBits>
float gradient_noise(double x, double z, const CornerBits& corner_bits) {
    double x_floor = std::floor(x), z_floor = std::floor(z);
    int64_t column = int64_t(x_floor), row = int64_t(z_floor);
    float u = float(x - x_floor), v = float(z - z_floor);
    auto corner = [&](uint32_t i, uint32_t j) {
        uint32_t bits = corner_bits(column + i, row + j);
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

inline float gradient_noise(double x, double z, uint32_t seed) {
    return gradient_noise(x, z, [seed](int64_t column, int64_t row) {
        return mix_bits(uint32_t(column) + mix_bits(uint32_t(row) + mix_bits(seed)));
    });
}

// A step of (columns, rows) on the unit grid, after which noise repeats, and after the same step turned by a right angle.
struct NoisePeriod {
    int64_t columns, rows;
};

// Corners that whole periods lead to each other have the same bits. As complex numbers, corner c = period * whole + rest:
// rest * conj(period) is what c * conj(period) leaves modulo |period|^2, part by part.
inline float gradient_noise(double x, double z, uint32_t seed, NoisePeriod period) {
    const int64_t norm = period.columns * period.columns + period.rows * period.rows;
    auto rest = [norm](int64_t part) { return (part % norm + norm) % norm; };
    return gradient_noise(x, z, [&](int64_t column, int64_t row) {
        int64_t real = rest(column * period.columns + row * period.rows);
        int64_t imaginary = rest(row * period.columns - column * period.rows);
        return mix_bits(uint32_t(real) + mix_bits(uint32_t(imaginary) + mix_bits(seed)));
    });
}

inline constexpr double k_longest_noise_period = 0x1p28;  // in wavelengths of the last octave

// Sum of octaves, each half as long and `gain` as strong; divided by the sum of the strengths and brought to
// a standard deviation of about 0.25. x, z in wavelengths of the first octave.
// period: in the same, and the noise repeats after it along x and along z; 0: it never does. Wavelengths give way a
// little, so that whole waves fill it. period * 2^octaves is at most k_longest_noise_period.
inline float fractal_noise(double x, double z, uint32_t octaves, float gain, uint32_t seed,
                           double period = 0.0) {
    float sum = 0.0f, strength = 1.0f, total = 0.0f;
    double x_share = 0.0, z_share = 0.0, waves_x = std::max(period, 1.0), waves_z = 0.0;
    if (period > 0.0) {
        x_share = x / period;
        z_share = z / period;
    }
    for (uint32_t octave = 0; octave < octaves; ++octave) {
        const uint32_t octave_seed = seed + octave * 0x9e3779b9u;
        if (period > 0.0) {
            NoisePeriod step{std::llround(waves_x), std::llround(waves_z)};
            sum += strength * gradient_noise(x_share * double(step.columns) - z_share * double(step.rows),
                                             x_share * double(step.rows) + z_share * double(step.columns) +
                                                 17.3 * double(octave),
                                             octave_seed, step);
        } else {
            sum += strength * gradient_noise(x, z, octave_seed);
        }
        total += strength * strength;
        strength *= gain;
        // Turned by about 37 degrees, so that the grids of the octaves do not show through together.
        auto turn = [](double& a, double& b) {
            double turned = 1.6 * a - 1.2 * b;
            b = 1.2 * a + 1.6 * b;
            a = turned;
        };
        turn(x, z);
        z += 17.3;
        turn(waves_x, waves_z);
    }
    return sum / std::sqrt(total) * 1.15f;
}

inline float smooth_step(float low, float high, float x) {
    float t = high > low ? glm::clamp((x - low) / (high - low), 0.0f, 1.0f) : (x < low ? 0.0f : 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

}  // namespace coppice
