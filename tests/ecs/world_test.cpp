#include <map>
#include <optional>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"
#include "runtime/ecs/world.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;

// What the world must behave like, in the slowest way.
struct Model {
    struct State {
        std::optional<Position> position;
        std::optional<Age> age;
        bool frozen = false;
        ChunkId chunk;
    };
    std::map<uint64_t, State> alive;
    std::vector<Entity> ever;
    std::vector<ChunkId> chunks;
    std::vector<ChunkId> gone_chunks;
};

void expect_same(World& world, const Model& model) {
    ASSERT_EQ(world.entity_count(), model.alive.size());
    for (Entity entity : model.ever) {
        auto found = model.alive.find(entity.bits());
        ASSERT_EQ(world.alive(entity), found != model.alive.end());
        if (found == model.alive.end()) {
            ASSERT_EQ(world.get<Age>(entity), nullptr);
            ASSERT_FALSE(world.has<Frozen>(entity));
            continue;
        }
        const Model::State& state = found->second;
        const Position* position = world.get<Position>(entity);
        const Age* age = world.get<Age>(entity);
        ASSERT_EQ(position != nullptr, state.position.has_value());
        ASSERT_EQ(age != nullptr, state.age.has_value());
        if (position) {
            ASSERT_EQ(*position, *state.position);
        }
        if (age) {
            ASSERT_EQ(*age, *state.age);
        }
        ASSERT_EQ(world.has<Frozen>(entity), state.frozen);
        ASSERT_EQ(world.get<Frozen>(entity) != nullptr, state.frozen);
    }
    // Queries see each entity once, with its own values and its own name.
    size_t seen = 0;
    world.query<>().each_chunk([&](ChunkView chunk) {
        for (uint32_t row = 0; row < chunk.size(); ++row) {
            auto found = model.alive.find(chunk.entity(row).bits());
            ASSERT_NE(found, model.alive.end());
            ASSERT_EQ(chunk.id(), found->second.chunk);
            ++seen;
        }
    });
    ASSERT_EQ(seen, model.alive.size());
    uint64_t sum = 0, expected = 0;
    world.query<const Age, Without<Frozen>>().each(
        [&](Entity entity, const Age& age) { sum += age.steps * 31 + entity.bits(); });
    for (const auto& [bits, state] : model.alive)
        if (state.age && !state.frozen) expected += state.age->steps * 31 + bits;
    ASSERT_EQ(sum, expected);
    for (ChunkId id : model.gone_chunks) ASSERT_FALSE(world.has_chunk(id));
    for (ChunkId id : model.chunks) {
        size_t count = 0;
        for (const auto& [bits, state] : model.alive) count += state.chunk == id;
        ASSERT_EQ(world.chunk(id).size(), count);
    }
}

void run_random_edits(World& world, Model& model, uint64_t seed, int step_count) {
    Random random(seed);
    auto forget_chunk = [&](uint64_t bits) { model.alive[bits].chunk = {}; };
    for (int step = 0; step < step_count; ++step) {
        Age age{random.next_bits()};
        Position position{random.next_unit(), 2, 3};
        Entity entity =
            model.ever.empty() ? Entity{} : model.ever[random.next_below(uint32_t(model.ever.size()))];
        auto found = model.alive.find(entity.bits());
        bool was_alive = found != model.alive.end();
        switch (random.next_below(14)) {
            case 0: {
                Entity made = world.create();
                model.alive[made.bits()] = {};
                model.ever.push_back(made);
                break;
            }
            case 1: {
                Entity made = world.create(age, position, Frozen{});
                model.alive[made.bits()] = {position, age, true, {}};
                model.ever.push_back(made);
                break;
            }
            case 2: {
                Entity made = world.create<Age>();
                model.alive[made.bits()] = {{}, Age{}, false, {}};
                model.ever.push_back(made);
                break;
            }
            case 3:
            case 4:
                ASSERT_EQ(world.destroy(entity), was_alive);
                model.alive.erase(entity.bits());
                break;
            case 5:
                ASSERT_EQ(world.add(entity, age), was_alive);
                if (!was_alive) break;
                if (!found->second.age) forget_chunk(entity.bits());
                found->second.age = age;
                break;
            case 6:
                ASSERT_EQ(world.add(entity, position), was_alive);
                if (!was_alive) break;
                if (!found->second.position) forget_chunk(entity.bits());
                found->second.position = position;
                break;
            case 7:
                ASSERT_EQ(world.add<Frozen>(entity), was_alive);
                if (!was_alive) break;
                if (!found->second.frozen) forget_chunk(entity.bits());
                found->second.frozen = true;
                break;
            case 8:
                ASSERT_EQ(world.remove<Age>(entity), was_alive && found->second.age);
                if (!was_alive || !found->second.age) break;
                forget_chunk(entity.bits());
                found->second.age.reset();
                break;
            case 9:
                ASSERT_EQ(world.remove<Frozen>(entity), was_alive && found->second.frozen);
                if (!was_alive || !found->second.frozen) break;
                forget_chunk(entity.bits());
                found->second.frozen = false;
                break;
            case 10: {
                if (random.next_below(8)) break;
                uint32_t count = random.next_below(4) ? random.next_below(60) : random.next_below(2500);
                auto [id, ages, positions, frozen] = world.create_chunk<Age, Position, Frozen>(count);
                ASSERT_EQ(ages.size(), count);
                ASSERT_TRUE(frozen.empty());
                for (uint32_t row = 0; row < count; ++row) {
                    ages[row] = {age.steps + row};
                    positions[row] = {float(row), position.x, 0};
                    Entity made = world.chunk(id).entity(row);
                    model.alive[made.bits()] = {positions[row], ages[row], true, id};
                    if (row % 7 == 0) model.ever.push_back(made);
                }
                model.chunks.push_back(id);
                break;
            }
            case 11: {
                if (model.chunks.empty() || random.next_below(8)) break;
                size_t place = random.next_below(uint32_t(model.chunks.size()));
                ChunkId id = model.chunks[place];
                ASSERT_TRUE(world.destroy_chunk(id));
                ASSERT_FALSE(world.destroy_chunk(id));
                std::erase_if(model.alive, [&](const auto& item) { return item.second.chunk == id; });
                model.chunks.erase(model.chunks.begin() + std::ptrdiff_t(place));
                model.gone_chunks.push_back(id);
                break;
            }
            case 12:
                world.query<Age, With<Frozen>>().each([](Age& value) { value.steps += 3; });
                for (auto& [bits, state] : model.alive)
                    if (state.age && state.frozen) state.age->steps += 3;
                break;
            case 13:
                if (Age* value = world.get<Age>(entity)) {
                    value->steps ^= 1;
                    model.alive[entity.bits()].age->steps ^= 1;
                }
                break;
        }
        if (step % 500 == 0) expect_same(world, model);
        if (testing::Test::HasFatalFailure()) return;
    }
    expect_same(world, model);
}

TEST(World, BehavesAsTheNaiveModel) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        World world({.shared_chunk_bytes = seed == 1 ? size_t(1) : 4096});
        Model model;
        run_random_edits(world, model, seed, 6000);
        if (HasFatalFailure()) FAIL() << "seed " << seed;
    }
}

TEST(World, SameEditsSameHandlesAndHashOnAnyNumberOfThreads) {
    uint64_t hashes[2];
    std::vector<Entity> handles[2];
    for (int run = 0; run < 2; ++run) {
        set_thread_limit(run ? 2 : 1);
        World world;
        Model model;
        run_random_edits(world, model, 99, 3000);
        hashes[run] = world.hash();
        handles[run] = model.ever;
    }
    set_thread_limit(0);
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(handles[0], handles[1]);
}

TEST(World, NoEntityIsNeverAlive) {
    World world;
    EXPECT_FALSE(world.alive({}));
    EXPECT_FALSE(world.destroy({}));
    EXPECT_FALSE(world.add(Entity{}, Age{}));
    world.create(Age{});
    world.create_chunk<Age>(5);
    EXPECT_FALSE(world.alive({}));
    EXPECT_FALSE(world.alive({UINT32_MAX, 1}));
    EXPECT_FALSE(world.alive({0, 0}));
    EXPECT_FALSE(world.alive({1, 0}));
}

TEST(World, StaleHandlesStayDeadWhenTheirIndexIsReused) {
    World world;
    Entity first = world.create(Age{1});
    world.destroy(first);
    Entity second = world.create(Age{2});
    EXPECT_EQ(first.index, second.index);
    EXPECT_GT(second.generation, first.generation);
    EXPECT_EQ(world.get<Age>(first), nullptr);
    EXPECT_FALSE(world.destroy(first));
    EXPECT_EQ(world.get<Age>(second)->steps, 2u);

    auto [old_tile, old_ages] = world.create_chunk<Age>(10);
    Entity old_entity = world.chunk(old_tile).entity(3);
    world.destroy_chunk(old_tile);
    auto [new_tile, new_ages] = world.create_chunk<Age>(10);
    for (Age& age : new_ages) age = {7};
    EXPECT_EQ(world.chunk(new_tile).entity(3).index, old_entity.index);
    EXPECT_FALSE(world.alive(old_entity));
    EXPECT_FALSE(world.has_chunk(old_tile));
    EXPECT_TRUE(world.column<Age>(old_tile).empty());
}

TEST(World, EntitiesLeaveABulkChunkOneByOne) {
    World world;
    auto [id, ages] = world.create_chunk<Age>(2000);
    for (uint32_t row = 0; row < 2000; ++row) ages[row] = {row};
    std::vector<Entity> entities;
    for (uint32_t row = 0; row < 2000; ++row) entities.push_back(world.chunk(id).entity(row));
    for (uint32_t i = 0; i < 2000; i += 2) EXPECT_TRUE(world.destroy(entities[i]));
    EXPECT_TRUE(world.add(entities[1], Position{1, 2, 3}));
    EXPECT_EQ(world.chunk(id).size(), 999u);
    EXPECT_EQ(world.entity_count(), 1000u);
    for (uint32_t i = 0; i < 2000; ++i) {
        ASSERT_EQ(world.alive(entities[i]), i % 2 == 1);
        if (i % 2) {
            ASSERT_EQ(world.get<Age>(entities[i])->steps, i);
        }
    }
    EXPECT_TRUE(world.destroy_chunk(id));
    EXPECT_EQ(world.entity_count(), 1u);
    EXPECT_EQ(world.get<Age>(entities[1])->steps, 1u);
}

TEST(World, ABulkChunkMayBeEmptyOrBecomeEmpty) {
    World world;
    auto [empty, no_ages] = world.create_chunk<Age>(0);
    EXPECT_TRUE(empty);
    EXPECT_TRUE(no_ages.empty());
    auto [one, ages] = world.create_chunk<Age>(1);
    ages[0] = {};
    world.destroy(world.chunk(one).entity(0));
    EXPECT_EQ(world.chunk(one).size(), 0u);
    EXPECT_EQ(world.entity_count(), 0u);
    world.query<const Age>().each_chunk([](ChunkView, std::span<const Age>) { ADD_FAILURE(); });
    EXPECT_TRUE(world.destroy_chunk(empty));
    EXPECT_TRUE(world.destroy_chunk(one));
}

TEST(World, AChunkOfTagsOnlyHoldsEntities) {
    World world;
    auto [id, frozen] = world.create_chunk<Frozen>(100);
    EXPECT_TRUE(frozen.empty());
    EXPECT_EQ(world.query<With<Frozen>>().count(), 100u);
    EXPECT_TRUE(world.has<Frozen>(world.chunk(id).entity(99)));
}

TEST(World, HashSeesStateNotHistory) {
    auto build = [](bool detour) {
        auto world = std::make_unique<World>();
        std::vector<Entity> entities;
        for (uint32_t i = 0; i < 1000; ++i)
            entities.push_back(world->create(Age{i}, Position{float(i), 0, 0}));
        auto [id, ages] = world->create_chunk<Age>(50, entities[0]);
        for (Age& age : ages) age = {5};
        if (detour) {
            // Rows, chunks and archetypes come to stand in another order.
            for (uint32_t i = 0; i < 1000; i += 3) world->add<Frozen>(entities[i]);
            for (uint32_t i = 0; i < 1000; i += 3) world->remove<Frozen>(entities[i]);
        }
        return std::pair(std::move(world), entities);
    };
    auto [straight, entities] = build(false);
    auto [detour, same_entities] = build(true);
    uint64_t hash = straight->hash();
    EXPECT_EQ(hash, detour->hash());

    detour->get<Age>(entities[500])->steps ^= 1;
    EXPECT_NE(hash, detour->hash());
    detour->get<Age>(entities[500])->steps ^= 1;
    EXPECT_EQ(hash, detour->hash());
    detour->add<Frozen>(entities[1]);
    EXPECT_NE(hash, detour->hash());
    detour->remove<Frozen>(entities[1]);
    detour->get<Position>(entities[0])->y = -0.0f;
    EXPECT_NE(hash, detour->hash());
    detour->get<Position>(entities[0])->y = 0.0f;
    std::swap(*detour->get<Age>(entities[3]), *detour->get<Age>(entities[4]));
    EXPECT_NE(hash, detour->hash());
    std::swap(*detour->get<Age>(entities[3]), *detour->get<Age>(entities[4]));
    World owned, other;
    for (World* world : {&owned, &other}) {
        Entity first = world->create(Age{1}), second = world->create(Age{1});
        std::get<1>(world->create_chunk<Age>(1, world == &owned ? first : second))[0] = {3};
    }
    EXPECT_NE(owned.hash(), other.hash());
    detour->add(entities[2], Cached{1});
    uint64_t cached = detour->hash();
    detour->get<Cached>(entities[2])->value = 2;
    EXPECT_EQ(cached, detour->hash());
}

TEST(World, MemoryOfTilesStaysNearThePayload) {
    World world;
    uint64_t before = world.memory_bytes();
    for (int tile = 0; tile < 200; ++tile) world.create_chunk<Position, Velocity, Age>(1000);
    EXPECT_LT(double(world.memory_bytes() - before) / 200'000, 36.0);
}

TEST(World, TenMillionEntities) {
    World world;
    std::vector<ChunkId> tiles;
    for (int i = 0; i < 10'000; ++i) tiles.push_back(std::get<0>(world.create_chunk<Frozen>(1000)));
    EXPECT_EQ(world.entity_count(), 10'000'000u);
    EXPECT_EQ(world.query<With<Frozen>>().count(), 10'000'000u);
    Entity last = world.chunk(tiles.back()).entity(999);
    EXPECT_TRUE(world.has<Frozen>(last));
    for (ChunkId id : tiles) world.destroy_chunk(id);
    EXPECT_EQ(world.entity_count(), 0u);
    EXPECT_FALSE(world.alive(last));
}

TEST(World, StreamingTilesKeepsMemoryBounded) {
    World world;
    std::vector<ChunkId> tiles;
    size_t after_warm_up = 0;
    Random random(3);
    for (int step = 0; step < 3000; ++step) {
        auto [id, ages] = world.create_chunk<Age>(500 + random.next_below(3000));
        for (Age& age : ages) age = {1};
        if (step % 5 == 0) world.destroy(world.chunk(id).entity(0));
        tiles.push_back(id);
        if (tiles.size() > 20) {
            size_t place = random.next_below(20);
            world.destroy_chunk(tiles[place]);
            tiles.erase(tiles.begin() + std::ptrdiff_t(place));
        }
        if (step == 1000) after_warm_up = world.memory_bytes();
    }
    EXPECT_LT(world.memory_bytes(), after_warm_up * 3 / 2);
    for (ChunkId id : tiles) world.destroy_chunk(id);
    world.trim();
    EXPECT_EQ(world.entity_count(), 0u);
    EXPECT_LT(world.memory_bytes(), 100'000u);
}

#ifndef NDEBUG
TEST(WorldDeathTest, EditingWhileIteratingIsAMistake) {
    World world;
    Entity entity = world.create(Age{});
    EXPECT_DEATH(world.query<const Age>().each([&](const Age&) { world.destroy(entity); }),
                 "structural edit");
}
#endif

}  // namespace
}  // namespace coppice
