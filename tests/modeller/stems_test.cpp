#include "plugins/modeller/stems.h"

#include <gtest/gtest.h>

namespace coppice::modeller {
namespace {

TreeParameters parameters(const char* json) {
    auto species = parse_species(json, "plant.json");
    EXPECT_TRUE(species) << to_string(species.error());
    return species ? species->tree : TreeParameters{};
}

StemTree grown(const TreeParameters& tree, uint64_t seed = 1) {
    auto stems = grow_stems(tree, "plant.json", Random(seed));
    EXPECT_TRUE(stems) << to_string(stems.error());
    return stems ? std::move(*stems) : StemTree{};
}

constexpr const char* k_plain =
    R"({"form": "tree", "height_m": 10, "base_fraction": 0.3, "shape": "conical",
        "levels": [{"curve_variation_deg": 0},
                   {"count": 24, "length": 0.4, "length_variation": 0, "curve_variation_deg": 0,
                    "down_angle_deg": 100, "down_angle_variation_deg": 0}]})";

TEST(Stems, a_straight_trunk_is_as_tall_as_asked_for) {
    StemTree tree = grown(parameters(k_plain));
    float top = 0.0f;
    for (const StemNode& node : tree.nodes) top = std::max(top, node.position.y);
    EXPECT_NEAR(top, 10.0f, 1e-4f);
    EXPECT_EQ(tree.stems[0].level, 0u);
}

TEST(Stems, branches_leave_above_the_base_at_their_down_angle_and_shorten_with_the_shape) {
    StemTree tree = grown(parameters(k_plain));
    ASSERT_EQ(tree.stems.size(), 25u);
    for (size_t i = 1; i < tree.stems.size(); ++i) {
        const Stem& stem = tree.stems[i];
        const StemNode& foot = tree.nodes[stem.first_node];
        EXPECT_GE(foot.position.y, 3.0f - 1e-3f);
        EXPECT_NEAR(foot.frame.along.y, -0.173648f, 1e-3f);  // cos 100 degrees
        float from_top = (10.0f - foot.position.y) / 7.0f;
        EXPECT_NEAR(stem.length_m, 10.0f * 0.4f * (0.2f + 0.8f * from_top), 0.01f);
        EXPECT_LE(foot.radius_m, tree.stems[0].base_radius_m);
    }
}

TEST(Stems, splits_are_spread_evenly_not_rolled) {
    // A quarter of a split at each of 8 inner nodes of each stem: two clones a stem and no luck involved.
    const char* json = R"({"form": "tree", "levels": [{"count": 8, "segments": 9, "segment_splits": 0.25}]})";
    for (uint64_t seed = 1; seed < 6; ++seed) {
        StemTree tree = grown(parameters(json), seed);
        size_t inner = 0;
        for (const Stem& stem : tree.stems) inner += stem.node_count - 2;
        size_t splits = tree.stems.size() - 8;
        EXPECT_NEAR(double(splits), 0.25 * double(inner), 1.0 + 0.3 * double(splits)) << seed;
        EXPECT_EQ(splits, grown(parameters(json), seed + 100).stems.size() - 8)
            << "the number must not depend on luck";
    }
}

TEST(Stems, base_splits_fork_the_trunk) {
    StemTree tree = grown(parameters(R"({"form": "tree", "levels": [{"base_splits": 2, "segments": 6}]})"));
    ASSERT_EQ(tree.stems.size(), 3u);
    EXPECT_LT(tree.nodes[tree.stems[1].first_node].radius_m, tree.nodes[tree.stems[0].first_node].radius_m);
    EXPECT_NEAR(glm::length(tree.nodes[tree.stems[1].first_node].position - tree.nodes[1].position), 0.0f,
                1e-5f);
}

TEST(Stems, attraction_lifts_and_lowers) {
    auto mean_height = [](float attraction) {
        TreeParameters tree = parameters(k_plain);
        tree.levels[1].attraction_up = attraction;
        StemTree stems = grown(tree);
        float rise = 0.0f;
        for (size_t i = 1; i < stems.stems.size(); ++i) {
            const Stem& stem = stems.stems[i];
            rise += stems.nodes[stem.first_node + stem.node_count - 1].position.y -
                    stems.nodes[stem.first_node].position.y;
        }
        return rise / float(stems.stems.size() - 1);
    };
    EXPECT_GT(mean_height(2.0f), mean_height(0.0f) + 0.2f);
    EXPECT_LT(mean_height(-2.0f), mean_height(0.0f) - 0.2f);
}

TEST(Stems, pruning_keeps_branches_inside_the_envelope) {
    TreeParameters tree = parameters(k_plain);
    tree.levels[1].length.center = 1.0f;
    tree.prune = {1.0f, 0.15f, 0.5f, 0.5f, 0.5f};
    StemTree stems = grown(tree);
    float widest = 0.0f;
    for (const StemNode& node : stems.nodes)
        widest = std::max(widest,
                          std::sqrt(node.position.x * node.position.x + node.position.z * node.position.z));
    EXPECT_LT(widest, 10.0f * 0.15f * 1.05f);
    tree.prune.ratio = 0.0f;
    float free = 0.0f;
    for (const StemNode& node : grown(tree).nodes) free = std::max(free, std::fabs(node.position.x));
    EXPECT_GT(free, 4.0f);
}

TEST(Stems, a_change_on_one_level_leaves_the_others_as_they_were) {
    const char* json = R"({"form": "tree", "levels": [{}, {"count": 12}, {"count": 6}]})";
    TreeParameters tree = parameters(json);
    StemTree before = grown(tree);
    tree.levels[2].down_angle.center = 1.2f;
    tree.levels[2].count = 11;
    StemTree after = grown(tree);
    size_t compared = 0;
    for (size_t i = 0; i < before.stems.size() && before.stems[i].level < 2; ++i) {
        ASSERT_EQ(before.stems[i].node_count, after.stems[i].node_count);
        for (uint32_t k = 0; k < before.stems[i].node_count; ++k) {
            vec3 a = before.nodes[before.stems[i].first_node + k].position;
            vec3 b = after.nodes[after.stems[i].first_node + k].position;
            ASSERT_EQ(a, b);
            ++compared;
        }
    }
    EXPECT_GT(compared, 60u);
    EXPECT_GT(after.stems.size(), before.stems.size());
}

}  // namespace
}  // namespace coppice::modeller
