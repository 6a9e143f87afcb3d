#include "plugins/vegetation/cook/openness.h"

#include <gtest/gtest.h>
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

TEST(OpennessGrid, ALoneLeafSeesTheWholeSky) {
    std::vector<PartDescription> parts(1);
    shapes::add_quad(parts[0], vec3(0, 2, 0), vec3(0.05f, 0, 0), vec3(0, 0, 0.05f));
    shapes::add_quad(parts[0], vec3(3, 0, 3), vec3(0.05f, 0, 0), vec3(0, 0, 0.05f));
    EXPECT_GT(OpennessGrid(parts, {false}).at(vec3(0.02f, 2, 0.02f)), 0.8f);
}

TEST(OpennessGrid, TheInsideOfACrownIsDarkerThanItsTop) {
    std::vector<PartDescription> parts{shapes::leaf_cloud(6000, 2, 0.08f, 3)};
    OpennessGrid open(parts, {false});
    EXPECT_GT(open.at(vec3(0, 7, 0)), open.at(vec3(0, 5, 0)) + 0.2f);
    EXPECT_GT(open.at(vec3(0, 5, 0)), open.at(vec3(0, 3.2f, 0)));
    EXPECT_GE(open.at(vec3(0, 3, 0)), 0.15f);
    EXPECT_LE(open.at(vec3(0, 100, 0)), 1.0f);
}

TEST(OpennessGrid, FollowsTheLawOfExtinction) {
    // A slab of thin horizontal leaves with leaf area index 2 seen from below: mean over the sky of
    // exp(-0.5 * 2 / cos) weighted by the cosine.
    std::vector<PartDescription> parts(1);
    Random random(5);
    for (int i = 0; i < 40000; ++i)
        shapes::add_quad(parts[0],
                         vec3(random.next_in(-10, 10), 1 + random.next_in(0, 0.8f), random.next_in(-10, 10)),
                         vec3(0.1414f, 0, 0), vec3(0, 0, 0.1414f));
    double expected = 0;
    for (int i = 0; i < 1000; ++i) {
        double cosine = std::sqrt(1 - (i + 0.5) / 1000);
        expected += double(portable_exp(float(-0.5 * 2 / cosine))) / 1000;
    }
    shapes::add_quad(parts[0], vec3(0, -10, 0), vec3(0.01f, 0, 0),
                     vec3(0, 0, 0.01f));  // so that the ground is far below
    EXPECT_NEAR(OpennessGrid(parts, {false}).at(vec3(0, -0.3f, 0)), expected, 0.06);
}

TEST(OpennessGrid, ChangesSmoothly) {
    std::vector<PartDescription> parts{shapes::leaf_cloud(20000, 2, 0.05f, 3)};
    OpennessGrid open(parts, {false});
    float previous = open.at(vec3(-3, 5, 0));
    for (float x = -3; x < 3; x += 0.005f) {
        float here = open.at(vec3(x, 5, 0));
        EXPECT_LT(std::fabs(here - previous), 0.05f);
        previous = here;
    }
}

TEST(OpennessGrid, TakesNothingAndOnePlace) {
    EXPECT_EQ(OpennessGrid({}, {}).at(vec3(0, 1, 0)), 1.0f);
    std::vector<PartDescription> flat(1);
    shapes::add_quad(flat[0], vec3(0), vec3(1e-4f, 0, 0), vec3(0, 0, 1e-4f));
    float open = OpennessGrid(flat, {false}).at(vec3(0));
    EXPECT_GE(open, 0.15f);
    EXPECT_LE(open, 1.0f);
}

}  // namespace
}  // namespace coppice
