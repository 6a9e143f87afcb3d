#include "plugins/modeller/taper.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/core/random.h"

namespace coppice::modeller {
namespace {

TEST(Taper, cylinder_cone_and_rounded_end) {
    EXPECT_FLOAT_EQ(tapered_radius(0.0f, 1.0f, 0.2f, 5.0f), 0.2f);
    EXPECT_FLOAT_EQ(tapered_radius(0.5f, 1.0f, 0.2f, 5.0f), 0.1f);
    EXPECT_FLOAT_EQ(tapered_radius(1.0f, 0.25f, 0.2f, 5.0f), 0.15f);
    EXPECT_FLOAT_EQ(tapered_radius(1.0f, 1.0f, 0.2f, 5.0f), 0.0f);
    // 2: a cylinder whose last radius is a half sphere.
    EXPECT_FLOAT_EQ(tapered_radius(2.0f, 0.0f, 0.2f, 5.0f), 0.2f);
    EXPECT_NEAR(tapered_radius(2.0f, 1.0f - 0.1f / 5.0f, 0.2f, 5.0f), std::sqrt(0.2f * 0.2f - 0.1f * 0.1f),
                1e-4f);
    EXPECT_NEAR(tapered_radius(2.0f, 1.0f, 0.2f, 5.0f), 0.0f, 1e-6f);
}

TEST(Taper, beads_vary_the_radius_between_zero_and_the_full_one) {
    float least = 1.0f, most = 0.0f;
    for (int i = 0; i < 400; ++i) {
        float radius = tapered_radius(3.0f, float(i) / 400.0f, 0.2f, 5.0f);
        least = std::min(least, radius);
        most = std::max(most, radius);
    }
    EXPECT_LT(least, 0.05f);
    EXPECT_NEAR(most, 0.2f, 1e-3f);
}

TEST(Taper, is_never_negative_nor_above_the_base) {
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
        float base = random.next_in(1e-4f, 1.0f);
        float radius = tapered_radius(random.next_in(0, 3), random.next_in(-0.5f, 1.5f), base,
                                      random.next_in(1e-3f, 30));
        ASSERT_GE(radius, 0.0f);
        ASSERT_LE(radius, base * 1.00001f);
    }
}

TEST(Taper, flare_is_whole_at_the_ground_and_gone_at_an_eighth) {
    EXPECT_NEAR(flare_factor(0.6f, 0.0f), 1.6f, 1e-5f);
    EXPECT_NEAR(flare_factor(0.6f, 0.125f), 1.0f, 1e-6f);
    EXPECT_NEAR(flare_factor(0.6f, 0.9f), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace coppice::modeller
