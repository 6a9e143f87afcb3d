// Which of a part's points a plant draws first. Were it the same ones for all, plants of one model that are worth a point each
// would all show the same point, with its colour and from above even its |n . v|: a draw of one, however many they are.
// So each plant has a first point of its own and a run that grows around it: to the next one, to the pair before or behind
// those two, and so on in aligned blocks twice as long each, so that it is always one stretch, and as well spread as a
// prefix of the order (cook/progressive_order.h) is, of which any aligned block has a point in each of as many equal
// stretches. From k_turned_points on it is the prefix.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

namespace coppice {

// Plants so near that they are drawn in octree cells ask for more: cells have the prefix to go on with.
inline constexpr uint32_t k_turned_points = 1024;

// bits & point_turn_mask is a plant's first point. 0 where there is no choice.
inline constexpr uint32_t point_turn_mask(uint32_t stored_count) {
    return stored_count > 0 ? std::min(k_turned_points, std::bit_floor(stored_count)) - 1 : 0;
}

// Where the first `count` points of a plant begin, in the part's order. Requires first_point as above, count <= stored_count.
inline constexpr uint32_t run_begin(uint32_t first_point, uint32_t count) {
    if (count == 0) return first_point;
    const uint32_t block = std::bit_floor(count), begin = first_point & ~(block - 1);
    return begin & block ? begin - (count - block) : begin;
}

// The point by which a run of n points grows to n + 1.
inline constexpr uint32_t point_of_run(uint32_t first_point, uint32_t n) {
    if (n == 0) return first_point;
    const uint32_t begin = run_begin(first_point, n), grown = run_begin(first_point, n + 1);
    return grown < begin ? grown : begin + n;
}

}  // namespace coppice
