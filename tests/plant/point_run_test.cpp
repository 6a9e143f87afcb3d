#include "plugins/vegetation/plant/point_run.h"

#include <vector>
#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr uint32_t k_counts[] = {1, 2, 3, 7, 64, 100, 1024, 3000};

TEST(PointRun, GrowsPointByPointAndStaysOneStretch) {
    for (uint32_t stored : k_counts)
        for (uint32_t bits = 0; bits < 2 * k_turned_points; bits += 7) {
            const uint32_t first_point = bits & point_turn_mask(stored);
            std::vector<bool> met(stored, false);
            for (uint32_t n = 0; n < stored; ++n) {
                const uint32_t point = point_of_run(first_point, n), begin = run_begin(first_point, n + 1);
                ASSERT_LT(point, stored);
                ASSERT_FALSE(met[point]);
                met[point] = true;
                ASSERT_LE(begin + n, stored - 1);
                ASSERT_TRUE(met[begin] && met[begin + n]) << "from end to end";
            }
        }
}

// As a prefix of an order by reversed digits is, a run of 2^j points and each half of it are aligned blocks.
TEST(PointRun, OfAPowerOfTwoIsAnAlignedBlock) {
    for (uint32_t first_point = 0; first_point < k_turned_points; first_point += 5)
        for (uint32_t count = 1; count <= k_turned_points; count *= 2) {
            const uint32_t begin = run_begin(first_point, count);
            EXPECT_EQ(begin % count, 0u);
            EXPECT_LE(begin, first_point);
            EXPECT_LT(first_point, begin + count);
        }
}

TEST(PointRun, ShowsEachPointAsOftenAndIsThePrefixFromThereOn) {
    for (uint32_t stored : k_counts)
        for (uint32_t count = 1; count <= stored; count += 1 + count / 3) {
            const uint32_t mask = point_turn_mask(stored);
            std::vector<uint32_t> shown(stored + 1, 0);
            for (uint32_t first_point = 0; first_point <= mask; ++first_point) {
                const uint32_t begin = run_begin(first_point, count);
                if (count > mask) {
                    EXPECT_EQ(begin, 0u);
                }
                for (uint32_t i = begin; i < begin + count; ++i) ++shown[i];
            }
            // Blocks of two and more are grown into from either side, so that at their ends it may be off by a half.
            for (uint32_t i = 0; i <= mask; ++i)
                if (std::has_single_bit(count)) {
                    EXPECT_EQ(shown[i], std::min(count, mask + 1)) << stored << ", " << count;
                } else {
                    EXPECT_GT(shown[i], 0u);
                }
        }
}

}  // namespace
}  // namespace coppice
