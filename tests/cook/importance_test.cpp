#include "plugins/vegetation/cook/importance.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

vec3 srgb(int r, int g, int b) {
    return {srgb_to_linear(float(r) / 255), srgb_to_linear(float(g) / 255), srgb_to_linear(float(b) / 255)};
}

TEST(ChooseImportance, PetalsOfADaisyStandOut) {
    const ColoredArea parts[] = {{srgb(75, 110, 50), 0.02, 0},     // leaves
                                 {srgb(80, 100, 55), 0.005, 0},    // stem
                                 {srgb(238, 238, 232), 0.009, 0},  // petals
                                 {srgb(215, 170, 30), 0.003, 0}};  // disc
    std::vector<float> importance = choose_importance(parts);
    EXPECT_EQ(importance[0], 1.0f);
    EXPECT_EQ(importance[1], 1.0f);
    EXPECT_NEAR(importance[2], 3.0f, 0.7f);
    EXPECT_GT(importance[3], 1.3f);
    EXPECT_LE(importance[3], 4.0f);
}

TEST(ChooseImportance, GreensAndBarkStayOrdinary) {
    const ColoredArea parts[] = {
        {srgb(60, 95, 40), 100, 0}, {srgb(95, 130, 60), 40, 0}, {srgb(105, 88, 68), 20, 0}};
    for (float importance : choose_importance(parts)) EXPECT_EQ(importance, 1.0f);
}

TEST(ChooseImportance, MajorityIsAGroupNotTheLargestPart) {
    // Three greens together outweigh the one red part.
    const ColoredArea parts[] = {{srgb(190, 20, 25), 5, 0},
                                 {srgb(60, 95, 40), 3, 0},
                                 {srgb(65, 100, 42), 3, 0},
                                 {srgb(70, 105, 45), 3, 0}};
    std::vector<float> importance = choose_importance(parts);
    EXPECT_GT(importance[0], 2.0f);
    EXPECT_EQ(importance[2], 1.0f);
}

TEST(ChooseImportance, TheAuthorsWordCounts) {
    const ColoredArea parts[] = {{srgb(60, 95, 40), 1, 2.5f}, {srgb(240, 240, 240), 0.1, 0.5f}};
    EXPECT_EQ(choose_importance(parts), (std::vector<float>{2.5f, 0.5f}));
}

TEST(ChooseImportance, OnePartIsOrdinaryWhateverItsColor) {
    const ColoredArea parts[] = {{srgb(255, 0, 255), 1, 0}};
    EXPECT_EQ(choose_importance(parts), std::vector<float>{1.0f});
    EXPECT_TRUE(choose_importance({}).empty());
}

}  // namespace
}  // namespace coppice
