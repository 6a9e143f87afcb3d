#include "plugins/vegetation/plant/leaf_bands.h"

#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace coppice {
namespace {

TEST(LeafBands, EveryLevelIsTheEndOfOneBandAndLittleMoreThanItself) {
    for (auto [full, least] : {std::pair{1u, 1u}, {64u, 16u}, {64u, 64u}, {1000u, 16u}, {999u, 17u}, {33u, 32u}}) {
        const uint32_t stored = banded_leaf_count(full, least);
        EXPECT_LE(stored, 3 * full);
        std::vector<uint32_t> band_ends;
        for (LeafBand band = first_band(full, least);; band = next_band(band, least)) {
            band_ends.push_back(band.first + band.size());
            if (band.is_last(least)) break;
        }
        EXPECT_EQ(band_ends.back(), stored);
        for (uint32_t count = least; count <= full; ++count) {
            const LeafRun run = leaves_of_level(full, least, count);
            EXPECT_GE(run.count, count);
            EXPECT_LE(2 * run.count, 3 * count + 1) << full << " " << count;
            EXPECT_NE(std::find(band_ends.begin(), band_ends.end(), run.first + run.count), band_ends.end());
        }
        EXPECT_EQ(leaves_of_level(full, least, full).first, 0u);
        EXPECT_EQ(leaves_of_level(full, least, least).count, least) << "the last level has nothing unborn";
    }
}

}  // namespace
}  // namespace coppice
