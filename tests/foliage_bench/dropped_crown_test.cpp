// Thinned crowns keep what they are said to keep.
#include "tools/foliage/dropped_crown.h"

#include <gtest/gtest.h>
#include <numeric>
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

TEST(DroppedCrown, KeepsTheLastOfTheOrderAndTheirAreaGrows) {
    const std::vector<Leaf> crown = made_crown(200, 3);
    std::vector<uint32_t> order(200);
    std::iota(order.begin(), order.end(), 0u);
    const std::vector<Leaf> thinned = thin_crown(crown, order, 0.25f, 2.0f);
    ASSERT_EQ(thinned.size(), 50u);
    for (size_t i = 0; i < 50; ++i)
        EXPECT_NEAR(leaf_area_m2(thinned[i]), 4.0 * leaf_area_m2(crown[150 + i]), 1e-6);
    EXPECT_TRUE(thin_crown({}, {}, 1.0f, 1.0f).empty());
}

TEST(DroppedCrown, DepthIsAreaOverWhatTheCrownShows) {
    // A box of 2 x 2 x 2 m shows pi m2 as an ellipsoid from each side; two faces of 4 m2 show half of that in the mean.
    std::vector<Leaf> faces;
    for (float z : {-1.0f, 1.0f})
        faces.push_back(
            {{vec3(-1, -1, z), vec3(1, -1, z), vec3(1, 1, z), vec3(-1, 1, z)}, vec3(0, 0, 1), vec3(0.1f)});
    EXPECT_NEAR(optical_depth(faces), 4.0f / k_pi, 1e-5f);
    EXPECT_EQ(optical_depth({}), 0.0f);
}

TEST(DroppedCrown, WithoutGrowthItThinsAndWithItCoversAboutTheSame) {
    const std::vector<Leaf> crown = made_crown(8000, 2);
    const std::vector<DroppedErrors> levels = measure_dropped(crown, CrownCoverage(crown));
    ASSERT_EQ(levels.size(), 4u);
    EXPECT_EQ(levels[0].leaf_count, 4000u);
    EXPECT_EQ(levels[3].leaf_count, 400u);
    for (const DroppedErrors& level : levels) {
        EXPECT_GT(level.unscaled, level.half) << level.leaf_count;
        EXPECT_GT(level.half, level.whole) << level.leaf_count;
        EXPECT_LT(level.whole, 0.12) << level.leaf_count;
        EXPECT_GT(level.whole_printed, 2.0 * level.whole) << "the outside is taken first";
    }
    EXPECT_GT(levels[3].unscaled, 0.5);
}

}  // namespace
}  // namespace coppice
