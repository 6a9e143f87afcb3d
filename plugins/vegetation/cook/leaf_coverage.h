// How much more or less of the sky a thinned crown covers than the full one, counted in pixels from some directions.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/cook/leaf_error.h"

namespace coppice {

// Over what the full crown covers, less 1: about mean + d^T by_direction d from direction d.
struct CoverageExcess {
    float mean = 0.0f;
    NormalSpread by_direction{};  // without trace
};

class LeafCoverage {
  public:
    // The crown that others are measured against.
    explicit LeafCoverage(std::span<const Leaf> crown);

    // Parallel; the same on any number of threads.
    CoverageExcess measure(std::span<const Leaf> leaves) const;

  private:
    static constexpr size_t k_direction_count = 12;
    using Pixels = std::array<uint64_t, k_direction_count>;
    Pixels count(std::span<const Leaf> leaves) const;

    vec3 center_;
    float pixels_per_m_;
    Pixels full_;
};

}  // namespace coppice
