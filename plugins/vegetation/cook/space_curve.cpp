// Source of the transposition: J. Skilling, Programming the Hilbert curve, 2004.
#include "plugins/vegetation/cook/space_curve.h"

#include <algorithm>
#include <utility>
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr int k_bits = 10;  // per axis

uint32_t hilbert_index(uint32_t x, uint32_t y, uint32_t z) {
    uint32_t axis[3] = {x, y, z};
    for (uint32_t q = 1u << (k_bits - 1); q > 1; q >>= 1) {
        uint32_t below = q - 1;
        for (uint32_t& a : axis) {
            if (a & q) {
                axis[0] ^= below;
            } else {
                uint32_t swap = (axis[0] ^ a) & below;
                axis[0] ^= swap;
                a ^= swap;
            }
        }
    }
    axis[1] ^= axis[0];
    axis[2] ^= axis[1];
    uint32_t flip = 0;
    for (uint32_t q = 1u << (k_bits - 1); q > 1; q >>= 1)
        if (axis[2] & q) flip ^= q - 1;
    uint32_t index = 0;
    for (int bit = k_bits - 1; bit >= 0; --bit)
        for (uint32_t a : axis) index = index << 1 | ((a ^ flip) >> bit & 1u);
    return index;
}

}  // namespace

std::vector<uint32_t> order_along_curve(std::span<const vec3> points) {
    Box box;
    for (vec3 p : points) box.include(p);
    vec3 size = points.empty() ? vec3(1) : box.size();
    float side = std::max({size.x, size.y, size.z, 1e-30f});
    std::vector<uint64_t> keys(points.size());
    constexpr size_t k_grain = 1 << 14;
    parallel_for(points.size(), k_grain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            vec3 cell = (points[i] - box.min) * (1023.99f / side);
            keys[i] = uint64_t(hilbert_index(uint32_t(cell.x), uint32_t(cell.y), uint32_t(cell.z))) << 32 | i;
        }
    });
    // Radix sort of the 30 key bits, 10 at a time; it is stable, so ties stay in the order of their indices.
    std::vector<uint64_t> sorted(keys.size());
    for (int shift = 32; shift < 62; shift += 10) {
        size_t first_of[1025] = {};
        for (uint64_t key : keys) ++first_of[(key >> shift & 1023u) + 1];
        for (int digit = 0; digit < 1024; ++digit) first_of[digit + 1] += first_of[digit];
        for (uint64_t key : keys) sorted[first_of[key >> shift & 1023u]++] = key;
        std::swap(keys, sorted);
    }
    std::vector<uint32_t> order(keys.size());
    for (size_t i = 0; i < keys.size(); ++i) order[i] = uint32_t(keys[i]);
    return order;
}

}  // namespace coppice
