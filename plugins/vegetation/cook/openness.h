// How much of the sky is seen from a place inside the crown, past the plant's own parts: what makes the
// inside of a tree dark. From a coarse grid of leaf area density; smooth, so that neighbours agree.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

class OpennessGrid {
  public:
    static constexpr int k_side_limit = 32;  // eight levels of openness need no finer grid
    // Surface area counts once where it is open and half where it is closed (parts_closed, one a part),
    // because light meets the front of a closed surface only. Parallel; the same on any number of threads.
    OpennessGrid(std::span<const PartDescription> parts, const std::vector<bool>& parts_closed);
    // In [0.15, 1]: 1 on a leaf alone in the air. Trilinear.
    float at(vec3 position_plant) const;

  private:
    float cell_m_ = 1.0f;
    vec3 origin_{0};  // middle of cell (0, 0, 0)
    std::array<int, 3> side_{1, 1, 1};
    float ground_plant_ = 0.0f, height_m_ = 1.0f;
    std::vector<float> open_;  // x fastest, then y, then z
};

}  // namespace coppice
