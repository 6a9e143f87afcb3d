#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/random.h"
#include "runtime/ecs/commands.h"
#include "runtime/ecs/world.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;

TEST(Commands, NothingHappensBeforeApply) {
    World world;
    Entity entity = world.create(Age{1});
    Commands commands;
    world.query<const Age>().each([&](Entity each, const Age&) {
        commands.destroy(each);
        commands.create(Age{2}, Frozen{});
    });
    EXPECT_TRUE(world.alive(entity));
    EXPECT_EQ(world.entity_count(), 1u);
    commands.apply(world);
    EXPECT_TRUE(commands.empty());
    EXPECT_FALSE(world.alive(entity));
    EXPECT_EQ(world.query<With<Frozen>>().count(), 1u);
    world.query<const Age>().each([&](const Age& age) { EXPECT_EQ(age.steps, 2u); });
    commands.apply(world);
    EXPECT_EQ(world.entity_count(), 1u);
}

TEST(Commands, TheOrderOfRecordingDecides) {
    World world;
    Entity entity = world.create();
    Commands commands;
    commands.add(entity, Age{1});
    commands.add(entity, Age{2});
    commands.remove<Age>(entity);
    commands.add(entity, Age{3});
    commands.add(entity, Position{1, 2, 3});
    commands.remove<Position>(entity);
    commands.apply(world);
    EXPECT_EQ(world.get<Age>(entity)->steps, 3u);
    EXPECT_FALSE(world.has<Position>(entity));
}

TEST(Commands, WhatIsToBeCreatedCanBeEdited) {
    World world;
    Commands commands;
    Entity first = commands.create(Age{1});
    Entity second = commands.create();
    Entity third = commands.create(Position{1, 1, 1});
    EXPECT_FALSE(first);
    EXPECT_FALSE(world.alive(first));
    commands.add(second, Age{7});
    commands.add<Frozen>(second);
    commands.destroy(first);
    commands.remove<Position>(third);
    commands.apply(world);
    EXPECT_EQ(world.entity_count(), 2u);
    size_t seen = 0;
    world.query<const Age, With<Frozen>>().each([&](const Age& age) {
        EXPECT_EQ(age.steps, 7u);
        ++seen;
    });
    EXPECT_EQ(seen, 1u);
    EXPECT_EQ(world.query<With<Position>>().count(), 0u);
}

TEST(Commands, EditsOfWhatIsGoneDoNothing) {
    World world;
    Entity entity = world.create(Age{1});
    Entity other = world.create(Age{2});
    auto [chunk, ages] = world.create_chunk<Age>(10);
    for (Age& age : ages) age = {};
    Commands commands;
    commands.destroy(entity);
    commands.add(entity, Position{});
    commands.remove<Age>(entity);
    commands.destroy(entity);
    commands.destroy({});
    commands.destroy_chunk(chunk);
    commands.destroy_chunk(chunk);
    commands.apply(world);
    EXPECT_EQ(world.entity_count(), 1u);
    EXPECT_EQ(world.get<Age>(other)->steps, 2u);
    EXPECT_EQ(world.query<With<Position>>().count(), 0u);
}

TEST(Commands, SameAsDirectEdits) {
    World direct, deferred;
    std::vector<Entity> entities;
    for (uint32_t i = 0; i < 500; ++i) {
        entities.push_back(direct.create(Age{i}));
        ASSERT_EQ(deferred.create(Age{i}), entities.back());
    }
    Random random(11);
    Commands commands;
    for (int step = 0; step < 4000; ++step) {
        Entity entity = entities[random.next_below(500)];
        Age age{random.next_bits()};
        switch (random.next_below(5)) {
            case 0:
                direct.add(entity, age);
                commands.add(entity, age);
                break;
            case 1:
                direct.add<Frozen>(entity);
                commands.add<Frozen>(entity);
                break;
            case 2:
                direct.remove<Frozen>(entity);
                commands.remove<Frozen>(entity);
                break;
            case 3:
                direct.create(age, Position{1, 2, float(step)});
                commands.create(age, Position{1, 2, float(step)});
                break;
            case 4:
                if (step % 10) break;
                direct.destroy(entity);
                commands.destroy(entity);
                break;
        }
        if (random.next_below(100) == 0) commands.apply(deferred);
    }
    commands.apply(deferred);
    EXPECT_GT(direct.entity_count(), 500u);
    EXPECT_EQ(direct.hash(), deferred.hash());
}

}  // namespace
}  // namespace coppice
