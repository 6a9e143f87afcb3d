// The trees of the papers have the papers' numbers of leaves, and a crown's levels are those that are asked for.
#include "tools/foliage/crown.h"

#include <gtest/gtest.h>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/cook/collapse_leaves.h"
#include "runtime/core/file.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

size_t leaves_of_species(const std::string& name) {
    const std::string path = COPPICE_CONTENT_DIR "/species/" + name + ".json";
    const auto text = read_text_file(path);
    EXPECT_TRUE(text);
    const auto plant = modeller::grow_plant(*text, path, 0);
    EXPECT_TRUE(plant) << to_string(plant.error());
    const auto crown = find_crown(*plant);
    EXPECT_TRUE(crown) << to_string(crown.error());
    return crown ? crown->size() : 0;
}

TEST(Crown, ThePapersTreesHaveAsManyLeaves) {
    EXPECT_EQ(leaves_of_species("carya_ovata"), 114'114u) << "Rebollo et al. 2006, Fig. 12";
    EXPECT_EQ(leaves_of_species("betula_lenta"), 40'000u);
    EXPECT_EQ(leaves_of_species("taxus_baccata"), 100'000u);
}

TEST(Crown, APlantWithoutLeavesIsRefused) {
    PlantDescription bare;
    bare.name = "stick";
    const auto crown = find_crown(bare);
    ASSERT_FALSE(crown);
    EXPECT_EQ(crown.error().id, ErrorId::value_out_of_range);
}

TEST(Crown, LevelsHaveTheLeavesAskedFor) {
    const std::vector<Leaf> leaves = made_crown(400, 7);
    const Crown crown(leaves, collapse_leaves(leaves, {.target_count = 20}));
    for (uint32_t count : {400u, 399u, 100u, 21u, 20u})
        EXPECT_EQ(crown.leaves_at(crown.level_of(count)).size(), count);
    EXPECT_EQ(crown.leaves_at(crown.level_of(3)).size(), 20u) << "there is none with fewer";
    EXPECT_EQ(crown.level_of(1000), 0u) << "nor with more";
    EXPECT_NEAR(crown_area_m2(crown.leaves_at(0)), crown_area_m2(leaves), 1e-9);
    EXPECT_EQ(crown_area_m2({}), 0.0);
}

}  // namespace
}  // namespace coppice
