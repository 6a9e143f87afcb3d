// The order in which a crown's leaves are dropped: the next is the one nearest to a place that wanders by the golden section
// about the crown's axis while it rises and falls, so that leaves that go one after the other are never near.
// Source: Digital Design of Nature, 10.4; ERRATA 11 for the positions. Deviates: heights and radii go through those that the
// leaves have, because places that fill a cylinder take the outside of a round crown first.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

enum class DropHeight : uint8_t {
    sawtooth,  // from the bottom to the top, and again
    sine,      // up and down; as printed, it is rather near the ends than in the middle
};

enum class DropPlaces : uint8_t {
    cylinder,  // about the crown, as printed
    crown,  // a height is that below which so many of the leaves are, a radius likewise of the leaves at that height
};

struct GoldenOrderSettings {
    DropPlaces places = DropPlaces::crown;
    DropHeight height = DropHeight::sawtooth;
    // p_h: after so many places radii begin anew; >= 1. After 34, 55 ... places the angle is nearly where it was, and places
    // would fall on each other; 33 is far from that.
    uint32_t turn_places = 33;
    // Of radii for one period of heights; > 0. No whole number, or the same radii would always meet the same heights.
    float turns_per_rise = 5.618f;
};

// A permutation of the places, the first to go first. Requires finite places, fewer than 2^30. n log n. Same input, same order.
std::vector<uint32_t> golden_drop_order(std::span<const vec3> places_plant,
                                        const GoldenOrderSettings& settings);

}  // namespace coppice
