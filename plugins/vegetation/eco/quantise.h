// A population as a few models: its individuals clustered about k of their own (medoids), each drawn as the medoid
// nearest to it, scaled to its height. Pure: same individuals, same answer, on any number of threads; ties go to the
// lower index.
// Source: model quantisation, Deussen et al. 1998 and 2002, 3. Deviates: clusters of what plants look like instead of
// what made them grow, and medoids instead of means, because a mean of plants is no plant.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/eco/plant_features.h"

namespace coppice {

// Of one individual drawn as another, by the ratio of heights; beyond it the other's leaves would look like toys.
inline constexpr float k_quantise_scale_most = 4.0f, k_quantise_scale_least = 0.25f;

struct Quantised {
    std::vector<uint32_t> medoids;  // the individuals that become models; ascending
    // Of each individual: which of the medoids it is drawn as, and how many times as tall. A medoid is itself.
    std::vector<uint32_t> medoid_of;
    std::vector<float> scale_of;
    // [c - 1]: RMS over the individuals of the distance from an individual to what is drawn for it, with c models.
    // In spreads. Never rises with c; 0 where c is the number of individuals.
    std::vector<float> error_by_count;
};

// The distance compares, after scaling, crown widths, crown base, areas seen along three axes, leaf area and leaf
// colour, each over its spread: the standard deviation in the population, or what begins to be seen where that is less
// (5 % of a length's mean, 10 % of an area's, 0.02 of a colour). All weigh the same, colour a third a channel; the weights
// add up to 1, so that plants one spread apart in everything are at distance 1.
// Medoids grow one by one, each time from the individual that is drawn worst, then swapped with others while that lowers
// the error (the eager swaps of Schubert and Rousseeuw 2021), so that fewer models never draw better.
// Requires finite features with heights > 0, and 1 <= count <= individuals.size().
// Time: count x individuals^2; memory: 8 bytes x individuals^2.
Quantised quantise(std::span<const PlantFeatures> individuals, uint32_t count);

}  // namespace coppice
