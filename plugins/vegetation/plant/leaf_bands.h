// All levels of detail of a crown's leaves as lists that no level changes: nothing is extracted or uploaded, and plants of
// one model at different levels share them. Band j holds every leaf that is there at some level of L / 2^j down to
// L / 2^(j+1) leaves, in the order in which they are removed. So a level is the end of its band's list without those leaves
// that are not born yet; who draws looks at 1.5 times as many leaves as it draws at most. All bands hold less than 3 L.
// Ours, in place of LoDF's clusters (lod/leaf_forest.h) and of one list, of which every other leaf is unborn
// (lod/leaf_lifetimes.h).
#pragma once
#include <algorithm>
#include <cstdint>

namespace coppice {

// From `most` leaves, its first level, down to `fewest`, which is the next band's first level or the crown's last.
struct LeafBand {
    uint32_t most, fewest;
    uint32_t first;  // of its list, among all bands'
    uint32_t size() const { return 2 * most - fewest; }
    bool is_last(uint32_t least_count) const { return fewest == least_count; }
};

// Of a crown whose levels have full_count down to least_count leaves, 1 <= least_count <= full_count.
inline LeafBand first_band(uint32_t full_count, uint32_t least_count) {
    return {full_count, std::max(full_count / 2, least_count), 0};
}
inline LeafBand next_band(const LeafBand& band, uint32_t least_count) {
    return {band.fewest, std::max(band.fewest / 2, least_count), band.first + band.size()};
}

// Of all bands' lists. Requires full_count <= k_most_crown_leaves.
inline constexpr uint32_t k_most_crown_leaves = 1u << 29;
inline uint32_t banded_leaf_count(uint32_t full_count, uint32_t least_count) {
    LeafBand band = first_band(full_count, least_count);
    while (!band.is_last(least_count)) band = next_band(band, least_count);
    return band.first + band.size();
}

// Where the leaves of the level with `count` leaves are; those of them are drawn whose level of birth is at most
// full_count - count. Requires least_count <= count <= full_count.
struct LeafRun {
    uint32_t first, count;
};
inline LeafRun leaves_of_level(uint32_t full_count, uint32_t least_count, uint32_t count) {
    LeafBand band = first_band(full_count, least_count);
    while (count <= band.fewest && !band.is_last(least_count)) band = next_band(band, least_count);
    return {band.first + 2 * (band.most - count), 2 * count - band.fewest};
}

}  // namespace coppice
