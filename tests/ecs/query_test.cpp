#include <atomic>
#include <set>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/ecs/query.h"
#include "runtime/ecs/world.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;

TEST(Query, SelectsByComponents) {
    World world;
    Entity a = world.create(Age{1});
    Entity b = world.create(Age{2}, Position{});
    Entity c = world.create(Age{3}, Position{}, Frozen{});
    auto seen = [](auto query) {
        std::set<Entity> entities;
        query.each_chunk([&](ChunkView chunk, auto&&...) {
            for (uint32_t row = 0; row < chunk.size(); ++row) entities.insert(chunk.entity(row));
        });
        return entities;
    };
    EXPECT_EQ(seen(world.query<const Age>()), (std::set{a, b, c}));
    EXPECT_EQ(seen(world.query<const Age, Position>()), (std::set{b, c}));
    EXPECT_EQ(seen(world.query<const Age, Without<Frozen>>()), (std::set{a, b}));
    EXPECT_EQ(seen(world.query<With<Frozen>>()), (std::set{c}));
    EXPECT_EQ(seen(world.query<With<Position>, Without<Frozen>>()), (std::set{b}));
    EXPECT_EQ(seen(world.query<const Velocity>()), (std::set<Entity>{}));
    EXPECT_EQ(seen(world.query<>()), (std::set{a, b, c}));
}

TEST(Query, SeesArchetypesThatAppearLater) {
    World world;
    auto query = world.query<const Age>();
    EXPECT_EQ(query.count(), 0u);
    world.create(Age{});
    EXPECT_EQ(query.count(), 1u);
    world.create(Age{}, Velocity{});
    auto [id, ages, positions] = world.create_chunk<Age, Position>(10);
    EXPECT_EQ(query.count(), 12u);
    world.destroy_chunk(id);
    EXPECT_EQ(query.count(), 2u);
}

TEST(Query, HandsOutValuesInTheOrderOfItsTerms) {
    World world;
    Entity entity = world.create(Position{1, 2, 3}, Velocity{10, 20, 30}, Frozen{});
    world.query<const Velocity, With<Frozen>, Position>().each(
        [](const Velocity& velocity, Position& position) { position.x += velocity.x; });
    EXPECT_EQ(*world.get<Position>(entity), (Position{11, 2, 3}));
    static_assert(
        std::is_invocable_v<decltype([](ChunkView, std::span<const Velocity>, std::span<Position>) {}),
                            ChunkView, std::span<const Velocity>, std::span<Position>>);
}

TEST(Query, ACulledOwnerSkipsItsChunk) {
    World world;
    std::vector<ChunkId> chunks;
    std::vector<Entity> tiles;
    for (uint32_t number = 0; number < 10; ++number) {
        tiles.push_back(world.create(Tile{number % 2, number}));
        auto [id, ages] = world.create_chunk<Age>(100, tiles.back());
        for (Age& age : ages) age = {number};
        chunks.push_back(id);
    }
    world.create(Age{1000});  // without owner
    auto query = world.query<Age, Owner<const Tile>>();
    EXPECT_EQ(query.count(), 1000u);
    size_t kept = 0, asked = 0;
    query.each(
        [&](Age& age, const Tile& tile) {
            EXPECT_EQ(age.steps, tile.number);
            EXPECT_EQ(tile.visible, 1u);
            ++kept;
        },
        [&](ChunkView chunk, const Tile& tile) {
            EXPECT_EQ(chunk.owner(), tiles[tile.number]);
            EXPECT_EQ(chunk.id(), chunks[tile.number]);
            ++asked;
            return tile.visible != 0;
        });
    EXPECT_EQ(kept, 500u);
    EXPECT_EQ(asked, 10u);
    world.destroy(tiles[1]);
    EXPECT_EQ(query.count(), 900u);
    EXPECT_EQ(world.query<const Age>().count(), 1001u);
}

TEST(Query, ParallelGivesTheSameAsSerial) {
    for (unsigned threads : {1u, 2u, 4u}) {
        set_thread_limit(threads);
        World serial, parallel;
        for (World* world : {&serial, &parallel}) {
            for (uint32_t tile = 0; tile < 37; ++tile) {
                auto [id, ages, positions] = world->create_chunk<Age, Position>(tile * 29);
                for (uint32_t row = 0; row < ages.size(); ++row) {
                    ages[row] = {row};
                    positions[row] = {};
                }
            }
            for (uint32_t i = 0; i < 5000; ++i) world->create(Age{i}, Velocity{});
        }
        auto step = [](Entity entity, Age& age) { age.steps = age.steps * 7 + entity.index; };
        serial.query<Age>().each(step);
        std::atomic<size_t> visited{0};
        parallel.query<Age>().parallel_each([&](Entity entity, Age& age) {
            step(entity, age);
            ++visited;
        });
        EXPECT_EQ(visited, serial.entity_count());
        EXPECT_EQ(serial.hash(), parallel.hash());
        std::atomic<size_t> in_chunks{0};
        parallel.query<const Age>().parallel_each_chunk(
            [&](ChunkView, std::span<const Age> ages) { in_chunks += ages.size(); }, 1);
        EXPECT_EQ(in_chunks, serial.entity_count());
    }
    set_thread_limit(0);
}

TEST(Query, GetsOtherEntitiesWithinItsTerms) {
    World world;
    Entity entity = world.create(Age{4}, Position{});
    auto query = world.query<const Age, Position>();
    EXPECT_EQ(query.get<const Age>(entity)->steps, 4u);
    query.get<Position>(entity)->x = 2;
    EXPECT_EQ(query.get<const Position>(entity)->x, 2);
    EXPECT_EQ(query.get<const Age>({}), nullptr);
}

TEST(Query, AccessFollowsConstness) {
    Access reader = Query<const Age, const Position>::access();
    Access writer = Query<Age>::access();
    Access other = Query<Velocity, const Position, With<Age>, Without<Frozen>>::access();
    Access owner = Query<const Velocity, Owner<const Age>>::access();
    EXPECT_TRUE(reader.conflicts_with(writer));
    EXPECT_TRUE(writer.conflicts_with(reader));
    EXPECT_TRUE(writer.conflicts_with(writer));
    EXPECT_FALSE(reader.conflicts_with(reader));
    EXPECT_FALSE(reader.conflicts_with(other));
    EXPECT_FALSE(writer.conflicts_with(other));
    EXPECT_TRUE(writer.conflicts_with(owner));
    EXPECT_TRUE(other.conflicts_with(owner));
}

}  // namespace
}  // namespace coppice
