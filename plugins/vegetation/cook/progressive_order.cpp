// Source of the scrambling: S. Laine, T. Karras, Stratified sampling for stochastic transparency, 2011, with
// N. Vegdahl's constants: a hash in which every bit depends on lower ones only is Owen's nested scrambling.
#include "plugins/vegetation/cook/progressive_order.h"

#include <bit>
#include "runtime/core/hash.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

std::vector<uint32_t> shuffle(uint32_t count, uint64_t seed) {
    std::vector<uint32_t> order(count);
    for (uint32_t i = 0; i < count; ++i) order[i] = i;
    Random random(seed);
    for (uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next_below(i)]);
    return order;
}

// Each binary digit is turned by a coin that depends on the digits below it.
uint32_t scramble_digits(uint32_t x, uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

uint32_t reverse_digits(uint32_t x, int digits) {
    uint32_t reversed = 0;
    for (int i = 0; i < digits; ++i) reversed |= (x >> i & 1u) << (digits - 1 - i);
    return reversed;
}

}  // namespace

std::vector<uint32_t> make_prefix_order(uint32_t count, PrefixOrder order, uint64_t seed) {
    if (order == PrefixOrder::shuffled) return shuffle(count, seed);
    std::vector<uint32_t> places;
    places.reserve(count);
    // The list need not have a power of two entries: the sequence runs over the tree's leaves, which are laid
    // on the list evenly, and a leaf that meets an entry met before is passed over. Laid on evenly, not cut
    // off at the end, so that prefixes of 2^j still meet 2^j equal stretches.
    int digits = count > 1 ? std::bit_width(count - 1) : 0;
    uint64_t leaf_count = uint64_t(1) << digits;
    uint32_t coins = uint32_t(Random(seed).next_bits());
    std::vector<bool> met(count, false);
    for (uint64_t i = 0; places.size() < count && i < leaf_count; ++i) {
        uint64_t leaf = reverse_digits(scramble_digits(uint32_t(i), coins), digits);
        uint32_t place = uint32_t(leaf * count >> digits);
        if (met[place]) continue;
        met[place] = true;
        places.push_back(place);
    }
    return places;
}

}  // namespace coppice
