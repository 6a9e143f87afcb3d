// How far a level of a crown is off what the full crown covers, counted in pixels: a witness that shares no direction and no
// resolution with what the cook steers by (cook/leaf_coverage.h).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

class CrownCoverage {
  public:
    static constexpr size_t k_direction_count = 16;
    // The crown that levels are compared with.
    explicit CrownCoverage(std::span<const Leaf> crown);

    // |pixels / the full crown's - 1|, of the direction from which it is largest. Directions from which the full crown
    // covers nothing are left out. Parallel; the same on any number of threads.
    double worst_error(std::span<const Leaf> leaves) const;

  private:
    using Pixels = std::array<uint64_t, k_direction_count>;
    Pixels count(std::span<const Leaf> leaves) const;

    Box box_;
    Pixels full_;
};

}  // namespace coppice
