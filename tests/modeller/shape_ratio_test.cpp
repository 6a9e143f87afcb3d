// The oracle is the paper's table, written out at the crown's top, middle and base.
#include "plugins/modeller/shape_ratio.h"

#include <gtest/gtest.h>

namespace coppice::modeller {
namespace {

struct Row {
    Shape shape;
    float top, middle, base;
};

TEST(ShapeRatio, agrees_with_the_papers_table) {
    const Row rows[] = {
        {Shape::conical, 0.2f, 0.6f, 1.0f},           {Shape::spherical, 0.2f, 1.0f, 0.2f},
        {Shape::hemispherical, 0.2f, 0.765685f, 1},   {Shape::cylindrical, 1, 1, 1},
        {Shape::tapered_cylindrical, 0.5f, 0.75f, 1}, {Shape::flame, 0, 0.714286f, 0},
        {Shape::inverse_conical, 1, 0.6f, 0.2f},      {Shape::tend_flame, 0.5f, 0.857143f, 0.5f},
    };
    for (const Row& row : rows) {
        EXPECT_NEAR(shape_ratio(row.shape, 0.0f), row.top, 1e-5f) << int(row.shape);
        EXPECT_NEAR(shape_ratio(row.shape, 0.5f), row.middle, 1e-5f) << int(row.shape);
        EXPECT_NEAR(shape_ratio(row.shape, 1.0f), row.base, 1e-5f) << int(row.shape);
        EXPECT_EQ(shape_ratio(row.shape, -3.0f), shape_ratio(row.shape, 0.0f)) << int(row.shape);
        EXPECT_EQ(shape_ratio(row.shape, 7.0f), shape_ratio(row.shape, 1.0f)) << int(row.shape);
    }
    EXPECT_NEAR(shape_ratio(Shape::flame, 0.7f), 1.0f, 1e-5f);
}

TEST(ShapeRatio, envelope_is_widest_at_its_peak_and_closed_outside) {
    EXPECT_NEAR(envelope_ratio(0.6f, 0.4f, 0.5f, 0.5f), 1.0f,
                1e-5f);  // 0.6 from the top is 0.4 from the base
    EXPECT_LT(envelope_ratio(0.3f, 0.4f, 0.5f, 0.5f), 0.75f);
    EXPECT_LT(envelope_ratio(0.9f, 0.4f, 0.5f, 0.5f), 0.75f);
    EXPECT_EQ(envelope_ratio(-0.01f, 0.4f, 0.5f, 0.5f), 0.0f);
    EXPECT_EQ(envelope_ratio(1.01f, 0.4f, 0.5f, 0.5f), 0.0f);
}

}  // namespace
}  // namespace coppice::modeller
