// Plants that grow into each other until some die: circular neighbourhoods, in which the dominated give way. The mean plant's mass
// then follows the -3/2 power of the density.
// Source: Deussen et al. 1998, 4.2. Deviates: growth is the same share a step for all that are not full-grown; the smaller
// of two that meet dies at once.
#pragma once
#include <cstdint>
#include <vector>
#include <glm/vec2.hpp>

namespace coppice {

using glm::dvec2;

struct Competitor {
    dvec2 at;
    double radius_m;  // of its neighbourhood, now; > 0
    double radius_most_m;
    uint32_t plant;  // of whoever asks; of equal ones that meet the lower lives
};

inline constexpr uint32_t k_competition_step_limit = 1000;

// Those that live after so many steps, with the radius they have by then; no two of their circles meet. Largest first.
std::vector<Competitor> compete(std::vector<Competitor> plants, uint32_t steps, double growth);

}  // namespace coppice
