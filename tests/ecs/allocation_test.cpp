// A warm frame must not touch the heap.
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/ecs/schedule.h"
#include "tests/ecs/components.h"
#include "tests/count_allocations.h"

namespace coppice {
namespace {
using namespace test;

TEST(Allocation, TheCounterCounts) {
    size_t before = g_allocation_count;
    World world;
    world.create(Age{});
    EXPECT_GT(g_allocation_count, before);
}

TEST(Allocation, WarmQueriesAllocateNothing) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "loops start threads under the thread sanitizer";
#endif
    World world;
    Entity tile = world.create(Tile{1, 0});
    auto [id, ages, positions] = world.create_chunk<Age, Position>(5000, tile);
    for (Age& age : ages) age = {};
    for (Position& position : positions) position = {};
    for (int i = 0; i < 2000; ++i) world.create(Age{}, Velocity{});
    uint64_t sum = 0;
    auto frame = [&] {
        world.query<Age, Without<Frozen>>().each([](Age& age) { ++age.steps; });
        world.query<const Age, Owner<const Tile>>().each(
            [&](Entity entity, const Age& age, const Tile&) { sum += age.steps + entity.index; });
        world.query<Position>().parallel_each([](Position& position) { position.x += 1; });
        sum += world.get<Tile>(tile)->visible + world.hash();
    };
    frame();
    frame();
    size_t before = g_allocation_count;
    for (int i = 0; i < 10; ++i) frame();
    EXPECT_EQ(g_allocation_count, before);
    EXPECT_NE(sum, 0u);
}

TEST(Allocation, WarmFramesOfAScheduleAllocateNothing) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "loops start threads under the thread sanitizer";
#endif
    World world;
    Schedule schedule(world);
    ChunkId tile;
    schedule.add(Phase::stream, 0, "stream", [&](World& edited) {
        edited.destroy_chunk(tile);
        auto [id, ages] = edited.create_chunk<Age>(1000);
        for (Age& age : ages) age = {1};
        edited.destroy(edited.chunk(id).entity(10));
        tile = id;
    });
    schedule.add(Phase::world, 0, "age", [](Query<Age> ages, Commands& commands) {
        ages.each([&](Entity entity, Age& age) {
            if (++age.steps == 2 && entity.index % 100 == 0) commands.add<Frozen>(entity);
        });
    });
    schedule.add(Phase::world, 1, "move",
                 [](Query<Position> all) { all.parallel_each([](Position& position) { position.x += 1; }); });
    schedule.add(Phase::lod, 0, "drop", [](Query<const Age, With<Frozen>> frozen, Commands& commands) {
        frozen.each([&](Entity entity, const Age&) { commands.destroy(entity); });
        commands.create(Position{});
    });
    schedule.add(Phase::report, 0, "clear", [](Query<const Position> all, Commands& commands) {
        all.each([&](Entity entity, const Position&) { commands.destroy(entity); });
    });
    for (int i = 0; i < 8; ++i) schedule.run();
    size_t before = g_allocation_count;
    for (int i = 0; i < 20; ++i) schedule.run();
    EXPECT_EQ(g_allocation_count, before);
    EXPECT_EQ(world.chunk(tile).size(), 989u);
}

}  // namespace
}  // namespace coppice
