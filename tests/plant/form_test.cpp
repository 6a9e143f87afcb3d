#include <gtest/gtest.h>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {
namespace {

TEST(DirectionForm, IsTheRootOfTheQuadraticForm) {
    DirectionForm form{{4.0f, 9.0f, 16.0f, 1.0f, 0.0f, 0.0f}};
    EXPECT_FLOAT_EQ(form.evaluate(vec3(1, 0, 0)), 2.0f);
    EXPECT_FLOAT_EQ(form.evaluate(vec3(0, 1, 0)), 3.0f);
    EXPECT_FLOAT_EQ(form.evaluate(vec3(0, 0, 1)), 4.0f);
    EXPECT_FLOAT_EQ(form.evaluate(vec3(0.6f, 0.8f, 0)), std::sqrt(4 * 0.36f + 9 * 0.64f + 2 * 0.48f));
}

TEST(DirectionForm, IsNeverNegativeNorNaN) {
    DirectionForm form{{-1.0f, -1.0f, -1.0f, 0.0f, 0.0f, 0.0f}};
    EXPECT_EQ(form.evaluate(vec3(0, 1, 0)), 0.0f);
    EXPECT_EQ(DirectionForm{}.evaluate(vec3(1, 0, 0)), 0.0f);
}

}  // namespace
}  // namespace coppice
