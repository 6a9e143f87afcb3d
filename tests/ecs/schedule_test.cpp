#include <string>
#include <thread>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/ecs/schedule.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;
using Names = std::vector<std::vector<std::string>>;

TEST(Schedule, PhasesFollowTheDataAndOrdersCountInside) {
    World world;
    Schedule schedule(world);
    std::string ran;
    auto note = [&](char name) { return [&ran, name](World&) { ran += name; }; };
    schedule.add(Phase::report, 0, "h", note('h'));
    schedule.add(Phase::draw, 0, "g", note('g'));
    schedule.add(Phase::shadow, 0, "f", note('f'));
    schedule.add(Phase::lod, 0, "e", note('e'));
    schedule.add(Phase::cull, 5, "d", note('d'));
    schedule.add(Phase::cull, -5, "c", note('c'));
    schedule.add(Phase::cull, 5, "D", note('D'));
    schedule.add(Phase::world, 0, "b", note('b'));
    schedule.add(Phase::stream, 0, "a", note('a'));
    schedule.add(Phase::input, 0, "0", note('0'));
    schedule.run();
    EXPECT_EQ(ran, "0abcdDefgh");
    schedule.run(Phase::cull);
    EXPECT_EQ(ran, "0abcdDefghcdD");
    EXPECT_STREQ(name_of(Phase::input), "input");
    EXPECT_STREQ(name_of(Phase::report), "report");
}

TEST(Schedule, DisjointSystemsShareABatch) {
    World world;
    Schedule schedule(world);
    schedule.add(Phase::world, 1, "write_age", [](Query<Age>) {});
    schedule.add(Phase::world, 2, "write_position", [](Query<Position, With<Age>>) {});
    schedule.add(Phase::world, 3, "read_age", [](const Query<const Age>&, Commands&) {});
    schedule.add(Phase::world, 4, "read_age_too", [](Query<const Age, const Velocity>) {});
    schedule.add(Phase::world, 5, "write_velocity", [](Query<Velocity>) {});
    schedule.add(Phase::world, 6, "observe", [](const World&) {});
    schedule.add(Phase::world, 7, "edit", [](World&) {});
    schedule.add(Phase::world, 8, "read_by_owner", [](Query<Velocity, Owner<const Tile>>) {});
    EXPECT_EQ(schedule.batches(Phase::world), (Names{{"write_age", "write_position"},
                                                     {"read_age", "read_age_too"},
                                                     {"write_velocity"},
                                                     {"observe"},
                                                     {"edit"},
                                                     {"read_by_owner"}}));
    EXPECT_TRUE(schedule.batches(Phase::cull).empty());

    // The last one waits for the deepest of those it conflicts with, not for the latest.
    schedule.add(Phase::lod, 1, "a", [](Query<Age>) {});
    schedule.add(Phase::lod, 2, "b", [](Query<const Age, Position>) {});
    schedule.add(Phase::lod, 3, "c", [](Query<Velocity>) {});
    schedule.add(Phase::lod, 4, "d", [](Query<const Position, const Velocity>) {});
    EXPECT_EQ(schedule.batches(Phase::lod), (Names{{"a", "c"}, {"b"}, {"d"}}));
}

TEST(Schedule, CommandsAreCarriedOutAtPhaseEndInOrderOfSystems) {
    World world;
    Schedule schedule(world);
    Entity entity = world.create(Age{0});
    size_t seen_in_phase = 0, seen_after = 0;
    schedule.add(Phase::world, 2, "second", [&](Commands& commands) { commands.add(entity, Age{2}); });
    schedule.add(Phase::world, 1, "first", [&](Commands& commands) {
        commands.add(entity, Age{1});
        commands.create(Age{9});
    });
    schedule.add(Phase::world, 3, "look", [&](Query<const Age> ages) { seen_in_phase = ages.count(); });
    schedule.add(Phase::cull, 0, "look", [&](Query<const Age> ages) { seen_after = ages.count(); });
    schedule.run();
    EXPECT_EQ(seen_in_phase, 1u);
    EXPECT_EQ(seen_after, 2u);
    EXPECT_EQ(world.get<Age>(entity)->steps, 2u);
}

// A small simulation that edits, streams, culls and moves.
uint64_t run_simulation(unsigned threads) {
    set_thread_limit(threads);
    World world;
    Schedule schedule(world);
    std::vector<ChunkId> tiles;
    uint32_t frame = 0;
    schedule.add(Phase::stream, 0, "stream", [&](World& edited) {
        Entity tile = edited.create(Tile{frame % 2, frame});
        auto [id, positions, velocities, ages] =
            edited.create_chunk<Position, Velocity, Age>(300 + frame, tile);
        for (uint32_t row = 0; row < positions.size(); ++row) {
            positions[row] = {float(row), 0, 0};
            velocities[row] = {0.5f, float(frame), 1};
            ages[row] = {row};
        }
        tiles.push_back(id);
        if (tiles.size() > 12) {
            edited.destroy(edited.chunk(tiles.front()).owner());
            edited.destroy_chunk(tiles.front());
            tiles.erase(tiles.begin());
        }
        ++frame;
    });
    schedule.add(Phase::world, 0, "move", [](Query<Position, const Velocity, Owner<const Tile>> moving) {
        moving.parallel_each(
            [](Position& position, const Velocity& velocity, const Tile&) {
                position.x += velocity.x * 0.1f;
                position.y += velocity.y * 0.1f;
            },
            [](ChunkView, const Tile& tile) { return tile.visible != 0; }, 1);
    });
    schedule.add(Phase::world, 1, "age", [](Query<Age, Without<Frozen>> ages, Commands& commands) {
        ages.each([&](Entity entity, Age& age) {
            if (++age.steps % 97 == 0) commands.add<Frozen>(entity);
            if (age.steps % 101 == 0) commands.destroy(entity);
        });
    });
    schedule.add(Phase::world, 2, "spawn", [](Query<const Tile> all, Commands& commands) {
        all.each([&](const Tile& tile) { commands.create(Age{tile.number}, Velocity{1, 2, 3}); });
    });
    schedule.add(Phase::cull, 0, "slow", [](Query<Velocity, const Position> all) {
        all.parallel_each(
            [](Velocity& velocity, const Position& position) { velocity.x -= position.x * 1e-3f; });
    });
    schedule.add(Phase::cull, 1, "thaw", [](Query<const Age, With<Frozen>> frozen, Commands& commands) {
        frozen.each([&](Entity entity, const Age& age) {
            if (age.steps % 2) commands.remove<Frozen>(entity);
        });
    });
    uint64_t hash = 0;
    for (int i = 0; i < 60; ++i) {
        schedule.run();
        hash = hash * 31 + world.hash();
    }
    EXPECT_GT(world.entity_count(), 3000u);
    EXPECT_GT(world.query<With<Frozen>>().count(), 0u);
    set_thread_limit(0);
    return hash;
}

TEST(Schedule, SameWorldOnAnyNumberOfThreads) {
    uint64_t one = run_simulation(1);
    EXPECT_EQ(one, run_simulation(2));
    EXPECT_EQ(one, run_simulation(5));
}

TEST(Schedule, ABatchIsOneLoopOfTheHost) {
    World world;
    std::vector<size_t> counts;
    Schedule schedule(world);
    schedule.add(Phase::world, 1, "write_age", [](Query<Age>) {});
    schedule.add(Phase::world, 2, "read_age", [](Query<const Age>) {});
    schedule.add(Phase::world, 3, "write_velocity", [](Query<Velocity>) {});
    set_job_runner(
        [](void* context, size_t count, size_t, JobBody body, void* work) {
            static_cast<std::vector<size_t>*>(context)->push_back(count);
            body(work, 0, count);
        },
        &counts);
    schedule.run(Phase::world);
    set_job_runner(nullptr, nullptr);
    EXPECT_EQ(counts, (std::vector<size_t>{2, 1}));
}

TEST(Schedule, UsesTheHostsThreads) {
    // A host that runs everything backwards, each range on a thread of its own.
    struct Host {
        size_t calls = 0;
    } host;
    uint64_t expected = run_simulation(1);
    set_job_runner(
        [](void* context, size_t count, size_t grain, JobBody body, void* work) {
            ++static_cast<Host*>(context)->calls;
            for (size_t first = (count - 1) / grain * grain + grain; first > 0; first -= grain) {
                size_t begin = first - grain;
                std::thread([&] { body(work, begin, std::min(count, begin + grain)); }).join();
            }
        },
        &host);
    uint64_t hash = run_simulation(0);
    set_job_runner(nullptr, nullptr);
    EXPECT_EQ(hash, expected);
    EXPECT_GT(host.calls, 0u);
}

}  // namespace
}  // namespace coppice
