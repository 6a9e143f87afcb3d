// Random numbers that are a pure function of (seed, stream, counter): no state is shared, so nothing depends on the
// order in which threads draw. The mapping to floats is ours, because the standard library's differs between vendors.
#pragma once
#include <cstdint>

namespace coppice {

class Random {
  public:
    // Different streams of one seed are independent.
    explicit Random(uint64_t seed, uint64_t stream = 0)
        : key_(mix(seed) ^ mix(stream + 0x632be59bd9b4e019ull)) {}

    uint64_t next_bits() { return mix(key_ + 0x9e3779b97f4a7c15ull * ++counter_); }
    // [0, 1): 24 bits.
    float next_unit() { return float(next_bits() >> 40) * 0x1p-24f; }
    // [low, high).
    float next_in(float low, float high) { return low + (high - low) * next_unit(); }
    // centre +- spread, uniform.
    float next_around(float center, float spread) { return center + spread * (2.0f * next_unit() - 1.0f); }
    // [0, count); count >= 1. Bias under 2^-32.
    uint32_t next_below(uint32_t count) { return uint32_t(((next_bits() >> 32) * uint64_t(count)) >> 32); }
    // A generator for a child, independent of how much was drawn here.
    Random fork(uint64_t stream) const { return Random(key_, stream); }

  private:
    static constexpr uint64_t mix(uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    uint64_t key_;
    uint64_t counter_ = 0;
};

}  // namespace coppice
