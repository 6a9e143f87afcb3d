// What a sweep says was sent is what the structures are known to send.
#include "tools/foliage/sweep_levels.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "plugins/vegetation/cook/collapse_leaves.h"
#include "plugins/vegetation/lod/leaf_lifetimes.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

constexpr uint32_t k_leaves = 1000;

std::vector<SweepStep> sweep(uint32_t step_count, uint32_t target_count = 50) {
    const std::vector<LeafCollapse> collapses =
        collapse_leaves(made_crown(k_leaves, 5), {.target_count = target_count});
    std::vector<uint32_t> target(sweep_words(k_leaves));
    return sweep_levels(k_leaves, collapses, target, {step_count, 2});
}

const ChangeCost& cost_of(const SweepStep& step, FoliageStructure structure) {
    return step.change[size_t(structure)];
}

TEST(SweepLevels, StepsAreUniformDownToTheCoarsest) {
    const std::vector<SweepStep> steps = sweep(19);
    ASSERT_EQ(steps.size(), 19u);
    for (size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i].leaf_count, 1000 - 50 * (i + 1));
    EXPECT_EQ(sweep(100'000).size(), 950u) << "no level twice";
    std::vector<uint32_t> target(sweep_words(1));
    EXPECT_TRUE(sweep_levels(1, {}, target, {}).empty());
}

TEST(SweepLevels, BytesAreThoseOfTheLeavesSent) {
    for (const SweepStep& step : sweep(19)) {
        EXPECT_EQ(cost_of(step, FoliageStructure::vdf).bytes, 4 * step.leaf_count);
        EXPECT_EQ(cost_of(step, FoliageStructure::lifetimes).bytes, 4u);
        EXPECT_GE(step.candidate_count, step.leaf_count);
        EXPECT_LT(step.candidate_count, 2 * step.leaf_count);
    }
    // One collapse: a cluster of it, with its number of leaves; the first ones are of two leaves that became one.
    const std::vector<SweepStep> single = sweep(950);
    EXPECT_EQ(cost_of(single.front(), FoliageStructure::lodf).bytes % 4, 0u);
    EXPECT_GE(cost_of(single.front(), FoliageStructure::lodf).bytes, 8u);
    uint64_t largest = 0;
    for (const SweepStep& step : single)
        largest = std::max(largest, cost_of(step, FoliageStructure::lodf).bytes);
    EXPECT_LT(largest, 4u * 500) << "one cluster, not the crown";
    // The fewer collapses at once, the fewer clusters.
    EXPECT_LT(sum_of(single, FoliageStructure::lodf).bytes / 950.0,
              sum_of(sweep(19), FoliageStructure::lodf).bytes / 19.0);
}

TEST(SweepLevels, SumsAreThoseOfTheSteps) {
    std::vector<SweepStep> steps(3);
    for (SweepStep& step : steps) step.change[size_t(FoliageStructure::lodf)] = {2.0, 0.5, 10};
    const SweepSum sum = sum_of(steps, FoliageStructure::lodf);
    EXPECT_EQ(sum.extract_ms, 6.0);
    EXPECT_EQ(sum.change_ms, 7.5);
    EXPECT_EQ(sum.bytes, 30.0);
    EXPECT_EQ(sum_of(steps, FoliageStructure::vdf).change_ms, 0.0);
}

}  // namespace
}  // namespace coppice
