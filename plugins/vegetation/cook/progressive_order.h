// The order in which a list is drawn by prefixes. shuffled: the paper's. progressive goes past it: of a list
// that is laid out along a space-filling curve every prefix is well spread, because the curve is visited in
// the order of a randomly scrambled van der Corput sequence (each prefix of 2^j entries has one in each of
// 2^j equal stretches).
#pragma once
#include <cstdint>
#include <vector>

namespace coppice {

enum class PrefixOrder : uint8_t { shuffled, progressive };

// A permutation of [0, count): entry i is the place along the curve that is visited as the i-th.
std::vector<uint32_t> make_prefix_order(uint32_t count, PrefixOrder order, uint64_t seed);

}  // namespace coppice
