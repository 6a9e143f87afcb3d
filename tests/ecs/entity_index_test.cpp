#include <set>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/ecs/world.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;

TEST(EntityIndex, NoHandleIsGivenTwice) {
    World world;
    std::set<uint64_t> seen;
    for (int round = 0; round < 300; ++round) {
        auto [id, ages] = world.create_chunk<Age>(round % 3 ? 10 : 1500);
        Entity loose = world.create(Age{1});
        for (uint32_t row = 0; row < ages.size(); ++row) {
            ages[row] = {};
            ASSERT_TRUE(seen.insert(world.chunk(id).entity(row).bits()).second);
        }
        ASSERT_TRUE(seen.insert(loose.bits()).second);
        if (round % 2) world.destroy(world.chunk(id).entity(0));
        world.destroy_chunk(id);
        world.destroy(loose);
        ASSERT_EQ(world.entity_count(), 0u);
    }
    for (uint64_t bits : seen) ASSERT_FALSE(world.alive(Entity::from_bits(bits)));
}

TEST(EntityIndex, IndicesComeBack) {
    World world({.index_page_limit = 4});  // 4,096 indices
    for (int round = 0; round < 1000; ++round) {
        auto [id, ages] = world.create_chunk<Age>(1000);
        ASSERT_TRUE(id);
        Entity kept;
        if (round % 3 == 1) world.destroy(world.chunk(id).entity(5));
        if (round % 3 == 2) {
            kept = world.chunk(id).entity(7);
            world.add<Frozen>(kept);
        }
        Entity loose = world.create(Age{});
        ASSERT_TRUE(loose);
        world.destroy_chunk(id);
        ASSERT_EQ(world.entity_count(), kept ? 2u : 1u);
        ASSERT_EQ(world.alive(kept), bool(kept));
        world.destroy(kept);
        world.destroy(loose);
    }
    EXPECT_EQ(world.refused_count(), 0u);
}

TEST(EntityIndex, SaysWhenItIsFull) {
    World world({.index_page_limit = 4});
    EXPECT_FALSE(std::get<0>(world.create_chunk<Age>(4097)));
    auto [all, ages] = world.create_chunk<Age>(4096);
    ASSERT_TRUE(all);
    EXPECT_EQ(ages.size(), 4096u);
    EXPECT_FALSE(world.create(Age{}));
    auto [none, no_ages] = world.create_chunk<Age>(1);
    EXPECT_FALSE(none);
    EXPECT_TRUE(no_ages.empty());
    EXPECT_FALSE(std::get<0>(world.create_chunk<Age>(UINT32_MAX)));
    EXPECT_EQ(world.refused_count(), 4099ull + UINT32_MAX);
    EXPECT_EQ(world.entity_count(), 4096u);
    EXPECT_FALSE(world.alive({4096, 1}));
    world.destroy_chunk(all);
    EXPECT_TRUE(std::get<0>(world.create_chunk<Age>(3000)));
}

TEST(EntityIndex, UsedUpGenerationsNeverComeBack) {
    World world({.index_page_limit = 1, .last_generation = 3});
    std::set<uint64_t> seen;
    while (Entity entity = world.create(Age{})) {
        ASSERT_LE(entity.generation, 3u);
        ASSERT_TRUE(seen.insert(entity.bits()).second);
        world.destroy(entity);
    }
    EXPECT_FALSE(world.create(Age{}));
    EXPECT_GE(seen.size(), 3u);
    for (uint64_t bits : seen) EXPECT_FALSE(world.alive(Entity::from_bits(bits)));

    World tiles({.index_page_limit = 1, .last_generation = 3});
    for (int round = 0; round < 3; ++round) {
        auto [id, ages] = tiles.create_chunk<Age>(100);
        ASSERT_TRUE(id);
        if (round == 1) tiles.destroy(tiles.chunk(id).entity(99));
        tiles.destroy_chunk(id);
    }
    EXPECT_FALSE(std::get<0>(tiles.create_chunk<Age>(1)));
    EXPECT_EQ(tiles.retired_index_count(), 1024u);
}

}  // namespace
}  // namespace coppice
