// FLIP's filters as one-dimensional kernels: what the eye resolves at a distance, and the edges and points it notices.
#pragma once
#include <cstdint>
#include <vector>

namespace coppice {

// Weights at -radius ... radius.
struct FlipKernel {
    std::vector<float> weights;
    uint32_t radius() const { return uint32_t(weights.size() / 2); }
};

struct FlipFilters {
    // Contrast sensitivity: sums of two-dimensional Gaussians, one kernel for both directions of each; all in all, the
    // weights of a sum add up to 1.
    std::vector<FlipKernel> achromatic, red_green, blue_yellow;
    // A Gaussian and its derivatives. Across an edge `edge`, along it `smooth`; for points likewise.
    FlipKernel smooth, edge, point;
    uint32_t largest_radius = 0;
};

// pixels_per_degree: at least 1, else the derivatives vanish.
FlipFilters make_flip_filters(double pixels_per_degree);

}  // namespace coppice
