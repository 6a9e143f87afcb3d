// The bands of a packed crown give, at every level, the leaves that replaying the collapses gives.
#include "plugins/vegetation/cook/pack_leaves.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include "plugins/vegetation/cook/collapse_leaves.h"
#include "plugins/vegetation/cook/find_leaves.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "plugins/vegetation/plant/leaf_bands.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

PartDescription part_of(const std::vector<Leaf>& crown) {
    PartDescription part;
    part.leaf = true;
    for (const Leaf& leaf : crown) {
        const uint32_t first = uint32_t(part.vertices.size());
        for (const vec3& corner : leaf.corners_plant)
            part.vertices.push_back({corner, leaf.normal_plant, leaf.color_linear});
        for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) part.indices.push_back(first + k);
    }
    return part;
}

PackedPart bounds_of(const PartDescription& part) {
    Box box;
    for (const auto& vertex : part.vertices) box.include(vertex.position_plant);
    PackedPart packed{};
    for (int axis = 0; axis < 3; ++axis) {
        packed.bounds_min[axis] = box.min[axis];
        packed.bounds_max[axis] = box.max[axis];
    }
    return packed;
}

using Corners = std::array<uint16_t, 12>;

TEST(PackLeaves, EveryLevelIsWhatReplayingGives) {
    const PartDescription part = part_of(made_crown(700, 5));
    const std::vector<Leaf> crown = find_leaves(part, weld_positions(part.vertices)).leaves;
    const PackedPart packed = bounds_of(part);
    const std::vector<PartDescription> parts{part};
    const OpennessGrid openness(parts, {false});
    const PackedLeaves leaves = pack_leaves(part, packed, openness, 1, INFINITY);
    ASSERT_EQ(leaves.full_count, 700u);
    EXPECT_EQ(leaves.least_count, 16u);
    ASSERT_EQ(leaves.leaves.size(), banded_leaf_count(700, 16));

    LeafCollapseSettings settings;
    settings.target_count = 16;
    const std::vector<LeafCollapse> collapses = collapse_leaves(crown, settings);
    const LeafGrid grid = leaf_grid(packed);
    auto corners_of = [&](const Leaf& leaf) {
        Corners corners;
        for (size_t k = 0; k < 4; ++k)
            for (int axis = 0; axis < 3; ++axis)
                corners[3 * k + size_t(axis)] = uint16_t(
                    std::clamp((leaf.corners_plant[k][axis] - grid.origin_plant[axis]) / grid.step_m[axis] + 0.5f,
                               0.0f, 65535.0f));
        return corners;
    };
    for (uint32_t count : {700u, 699u, 500u, 351u, 350u, 349u, 200u, 175u, 90u, 43u, 42u, 21u, 17u, 16u}) {
        const uint32_t level = 700 - count;
        std::vector<Leaf> made(crown);
        std::vector<bool> gone(700 + level, false);
        for (uint32_t i = 0; i < level; ++i) {
            made.push_back(collapsed_leaf(crown, collapses[i]));
            for (uint32_t removed : collapses[i].removed) gone[removed] = true;
        }
        std::vector<Corners> expected, drawn;
        for (size_t i = 0; i < made.size(); ++i)
            if (!gone[i]) expected.push_back(corners_of(made[i]));
        const LeafRun run = leaves_of_level(700, 16, count);
        for (uint32_t i = run.first; i < run.first + run.count; ++i)
            if (leaves.leaves[i].birth_level <= level) drawn.push_back(leaves.leaves[i].corners);
        std::sort(expected.begin(), expected.end());
        std::sort(drawn.begin(), drawn.end());
        EXPECT_EQ(drawn.size(), count);
        EXPECT_TRUE(drawn == expected) << count;
    }
}

TEST(PackLeaves, LevelsEndWhereTheyCoverOtherwise) {
    const PartDescription part = part_of(made_crown(700, 5));
    const std::vector<PartDescription> parts{part};
    const OpennessGrid openness(parts, {false});
    auto least_count = [&](float most_error) {
        return pack_leaves(part, bounds_of(part), openness, 1, most_error).least_count;
    };
    EXPECT_EQ(least_count(0.0f), 700u);  // quads are what they stand for, joined ones are not
    EXPECT_EQ(least_count(INFINITY), 16u);
    const uint32_t near = least_count(0.005f), far = least_count(0.03f);
    EXPECT_LE(far, near);
    EXPECT_LT(far, 700u);
}

// Of stars, which quads of the same area cover otherwise where they lie over each other.
TEST(PackLeaves, LeavesThatQuadsDoNotStandForAreNoCrown) {
    PartDescription part;
    part.leaf = true;
    for (uint32_t leaf = 0; leaf < 100; ++leaf) {
        const vec3 middle(0.02f * float(leaf % 10), 0.02f * float(leaf / 10), 0.001f * float(leaf));
        for (uint32_t ray = 0; ray < 6; ++ray) {
            const float turn = float(ray) * (k_pi / 3.0f), width = 0.05f;
            const uint32_t first = uint32_t(part.vertices.size());
            for (const vec3& corner :
                 {middle, middle + vec3(portable_cos(turn - width), portable_sin(turn - width), 0.0f),
                  middle + vec3(portable_cos(turn + width), portable_sin(turn + width), 0.0f)})
                part.vertices.push_back({corner, vec3(0, 0, 1), vec3(0.2f)});
            part.indices.insert(part.indices.end(), {first, first + 1, first + 2});
        }
    }
    const std::vector<PartDescription> parts{part};
    const OpennessGrid openness(parts, {false});
    EXPECT_EQ(pack_leaves(part, bounds_of(part), openness, 1).full_count, 0u);
    EXPECT_EQ(pack_leaves(part, bounds_of(part), openness, 1, INFINITY).full_count, 100u);
}

TEST(PackLeaves, FewLeavesAreNoCrown) {
    const PartDescription part = part_of(made_crown(63, 5));
    const std::vector<PartDescription> parts{part};
    const PackedLeaves leaves = pack_leaves(part, bounds_of(part), OpennessGrid(parts, {false}), 1);
    EXPECT_TRUE(leaves.leaves.empty());
    EXPECT_EQ(leaves.full_count, 0u);
}

}  // namespace
}  // namespace coppice
