#include "plugins/shared/noise.h"

#include <gtest/gtest.h>
#include "runtime/core/random.h"

namespace coppice {
namespace {

TEST(Noise, RepeatsAfterItsPeriodAndNotBefore) {
    Random random(1);
    for (double period : {1.0, 3.0, 7.3, 20.48}) {
        double apart = 0.0;
        for (int i = 0; i < 400; ++i) {
            double x = double(random.next_unit()) * period, z = double(random.next_unit()) * period;
            float here = fractal_noise(x, z, 6, 0.5f, 9, period);
            for (auto [i_period, j_period] : {std::pair(1, 0), std::pair(0, 1), std::pair(-2, 3)})
                EXPECT_NEAR(fractal_noise(x + i_period * period, z + j_period * period, 6, 0.5f, 9, period),
                            here, 2e-4f);
            apart += double(std::fabs(fractal_noise(x + 0.5 * period, z, 6, 0.5f, 9, period) - here));
        }
        EXPECT_GT(apart / 400.0, 0.1) << period;
    }
}

TEST(Noise, IsAsStrongWithAPeriodAsWithout) {
    for (double period : {0.0, 24.0}) {
        double sum = 0.0, squares = 0.0;
        constexpr int k_side = 300;
        for (int j = 0; j < k_side; ++j)
            for (int i = 0; i < k_side; ++i) {
                double value =
                    double(fractal_noise(24.0 * i / k_side, 24.0 * j / k_side, 4, 0.5f, 3, period));
                sum += value;
                squares += value * value;
            }
        EXPECT_NEAR(sum / (k_side * k_side), 0.0, 0.05) << period;
        EXPECT_NEAR(std::sqrt(squares / (k_side * k_side)), 0.25, 0.06) << period;
    }
}

TEST(Noise, HoldsAtTheLongestPeriod) {
    const double period = k_longest_noise_period / 16.0;
    float here = fractal_noise(0.3, 0.7, 4, 0.5f, 5, period);
    EXPECT_TRUE(std::isfinite(here));
    EXPECT_NEAR(fractal_noise(0.3 + period, 0.7 - period, 4, 0.5f, 5, period), here, 1e-3f);
}

}  // namespace
}  // namespace coppice
