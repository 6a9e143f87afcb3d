// Pops and shimmer of sequences whose energies are known by hand.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include "tools/accuracy/metrics.h"

namespace coppice {
namespace {

FloatPicture flat(uint32_t width, uint32_t height, float value) {
    return {width, height, std::vector<float>(size_t(width) * height * 3, value)};
}

// `picture` with its first square of k_block_px at another value.
FloatPicture with_first_square(FloatPicture picture, float value) {
    for (uint32_t y = 0; y < k_block_px; ++y)
        for (uint32_t i = 0; i < k_block_px * 3; ++i) picture.rgb[size_t(y) * picture.width * 3 + i] = value;
    return picture;
}

TEST(PopEnergy, IsTheSquareOfOneFlatStep) {
    PopEnergy pops;
    EXPECT_EQ(pops.energy(), 0.0);
    ASSERT_TRUE(pops.add(flat(40, 24, 0.25f), flat(40, 24, 0.25f)));
    EXPECT_EQ(pops.energy(), 0.0);
    ASSERT_TRUE(pops.add(flat(40, 24, 0.25f), flat(40, 24, 0.75f)));
    EXPECT_DOUBLE_EQ(pops.energy(), 0.25);
}

TEST(PopEnergy, AChangeSpreadOverStepsCountsAsOneOfThem) {
    const int steps = 8;
    PopEnergy at_once, spread;
    ASSERT_TRUE(at_once.add(flat(16, 16, 0.0f), flat(16, 16, 1.0f)));
    for (int i = 0; i < steps; ++i)
        ASSERT_TRUE(spread.add(flat(16, 16, float(i) / steps), flat(16, 16, float(i + 1) / steps)));
    EXPECT_DOUBLE_EQ(at_once.energy(), 1.0);
    EXPECT_DOUBLE_EQ(spread.energy(), 1.0 / (steps * steps));
}

TEST(PopEnergy, PlacesKeepTheirOwnLargestStep) {
    // Two of 32 x 16: one square pops by 0.5 in the first pair, both by 0.1 in the second.
    PopEnergy pops;
    const FloatPicture still = flat(32, 16, 0.0f);
    ASSERT_TRUE(pops.add(still, with_first_square(still, 0.5f)));
    EXPECT_DOUBLE_EQ(pops.energy(), 0.125);
    ASSERT_TRUE(pops.add(still, flat(32, 16, 0.1f)));
    EXPECT_NEAR(pops.energy(), (0.25 + 0.01) / 2, 1e-8);
}

TEST(PopEnergy, NarrowSquaresAtTheBorderWeighByTheirPixels) {
    // 20 wide: 16 that stay and 4 that pop.
    FloatPicture still = flat(20, 16, 0.0f), popped = with_first_square(flat(20, 16, 1.0f), 0.0f);
    PopEnergy pops;
    ASSERT_TRUE(pops.add(still, popped));
    EXPECT_DOUBLE_EQ(pops.energy(), 4.0 / 20.0);
}

TEST(PopEnergy, RefusesWhatIsNoPair) {
    PopEnergy pops;
    EXPECT_EQ(pops.add(flat(4, 4, 0), flat(4, 5, 0)).error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(pops.add({}, {}).error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(pops.add(flat(4, 4, NAN), flat(4, 4, 0)).error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(pops.energy(), 0.0);
    ASSERT_TRUE(pops.add(flat(4, 4, 0), flat(4, 4, 1)));
    EXPECT_EQ(pops.add(flat(2, 8, 0), flat(2, 8, 1)).error().id, ErrorId::value_out_of_range);
    EXPECT_DOUBLE_EQ(pops.energy(), 1.0);
}

TEST(Shimmer, IsTheRmsOverAllStepsAndPixels) {
    Shimmer shimmer;
    EXPECT_EQ(shimmer.rms(), 0.0);
    ASSERT_TRUE(shimmer.add(flat(3, 2, 0.5f)));
    EXPECT_EQ(shimmer.rms(), 0.0);  // until the second frame is in
    ASSERT_TRUE(shimmer.add(flat(3, 2, 0.75f)));
    EXPECT_DOUBLE_EQ(shimmer.rms(), 0.25);
    ASSERT_TRUE(shimmer.add(flat(3, 2, 0.75f)));
    EXPECT_DOUBLE_EQ(shimmer.rms(), std::sqrt(0.0625 / 2));
    // One value of 18 moves by 1.
    FloatPicture one = flat(3, 2, 0.75f);
    one.rgb[7] = 1.75f;
    ASSERT_TRUE(shimmer.add(one));
    EXPECT_DOUBLE_EQ(shimmer.rms(), std::sqrt((0.0625 + 1.0 / 18) / 3));
}

TEST(Shimmer, FlickerCountsThoughItGoesBack) {
    Shimmer shimmer;
    for (int i = 0; i < 9; ++i) ASSERT_TRUE(shimmer.add(flat(5, 5, float(i % 2))));
    EXPECT_DOUBLE_EQ(shimmer.rms(), 1.0);
}

TEST(Shimmer, RefusesAnotherSizeAndStaysAsItWas) {
    Shimmer shimmer;
    EXPECT_EQ(shimmer.add({}).error().id, ErrorId::value_out_of_range);
    ASSERT_TRUE(shimmer.add(flat(4, 4, 0)));
    EXPECT_EQ(shimmer.add(flat(8, 2, 1)).error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(shimmer.add(flat(4, 4, std::numeric_limits<float>::infinity())).error().id,
              ErrorId::value_out_of_range);
    ASSERT_TRUE(shimmer.add(flat(4, 4, 0.5f)));
    EXPECT_DOUBLE_EQ(shimmer.rms(), 0.5);
}

}  // namespace
}  // namespace coppice
