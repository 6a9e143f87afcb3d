// Which tiles are drawn and wished for while some are not in memory: with points as large as it takes then, a cloud covers
// pixels far beside its tile.
#include "plugins/vegetation/cull/list_tiles.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/terrain/field_terrain.h"
#include "runtime/ecs/world.h"

namespace coppice {
namespace {

constexpr dvec3 k_eye(0.0, 10.0, 0.0);

Frustum frustum_to_north() {
    Camera camera;
    camera.position_world = k_eye;
    return make_frustum(camera, 800, 700);
}

// Level, with a wall 30 m high from 96 to 120 m north of the viewer.
Horizon horizon_of_a_wall(const Frustum& frustum) {
    HeightField field;
    field.columns = field.rows = 129;
    field.cell_m = 4.0f;
    for (uint32_t row = 0; row < field.rows; ++row)
        for (uint32_t column = 0; column < field.columns; ++column)
            field.heights_m.push_back(field.z_of(row) <= -96.0f && field.z_of(row) >= -120.0f ? 30.0f : 0.0f);
    const FieldTerrain terrain(std::move(field), GroundSettings{}, dvec3(0.0));
    Horizon horizon;
    horizon.build(&terrain, k_eye, frustum, 1.0f);
    return horizon;
}

// A streamed tile of 20 m beside, in memory but for its plants, or a parent of two, the second of which is not.
class TileLists : public testing::Test {
  protected:
    static constexpr float k_finest_density =
        0.01f;  // a point ten metres: a stand-in 200 m away has splats of 30 px

    void add_tiles(std::span<const Tile> tiles, std::span<const TileLevels> levels) {
        auto [chunk, tile_rows, level_rows] = world_.create_chunk<Tile, TileLevels>(uint32_t(tiles.size()));
        ASSERT_TRUE(chunk);
        std::copy(tiles.begin(), tiles.end(), tile_rows.begin());
        std::copy(levels.begin(), levels.end(), level_rows.begin());
        chunk_ = chunk;
    }
    void add_plant(uint32_t row) {
        auto [chunk, positions, turns, models] =
            world_.create_chunk<PlantPosition, PlantTurn, PlantModel>(1, world_.chunk(chunk_).entity(row));
        ASSERT_TRUE(chunk);
        positions[0] = {0.0f, 0.0f, 0.0f, 1.0f};
        turns[0] = {};
        models[0] = {};
    }
    static Tile tile_at(vec3 center, vec3 size) { return {dvec3(center), {-0.5f * size, 0.5f * size}, 1}; }
    static TileLevels leaf(uint32_t cloud) {
        return {cloud, 0, 0, TileLevels::k_none, k_finest_density, 1, 1};
    }
    void list(const Horizon* horizon) {
        const TileList::Tiles tiles(world_);
        const TileList::Plants plants(world_);
        list_.list(tiles, plants, frustum_, k_eye, {1.0f, vec3(0.0f), horizon, 1.0f, 1.0f});
    }
    bool is_wished(uint32_t row, TileBlockKind kind) const {
        return std::any_of(list_.wishes().begin(), list_.wishes().end(),
                           [&](const TileWish& wish) { return wish.row == row && wish.kind == kind; });
    }

    World world_;
    ChunkId chunk_;
    const Frustum frustum_ = frustum_to_north();
    TileList list_;
};

// Its top is some ten pixels below the wall's.
TEST_F(TileLists, AStandInIsHiddenWhereItsLargePointsAre) {
    const Horizon horizon = horizon_of_a_wall(frustum_);
    const Tile tile = tile_at(vec3(0, 30, -200), vec3(20));
    const Box bounds{vec3(-10, 10, -210), vec3(10, 30, -190)};
    ASSERT_TRUE(horizon.hidden(bounds, 1.0f));
    ASSERT_FALSE(horizon.hidden(bounds, 30.0f));
    add_tiles(std::array{tile}, std::array{leaf(0)});
    list(&horizon);
    EXPECT_EQ(list_.clouds().size(), 1u);
    EXPECT_EQ(list_.stand_in_count, 1u);
    EXPECT_EQ(list_.hidden_tile_count, 0u);
    EXPECT_TRUE(is_wished(0, TileBlockKind::plants)) << "it would stand there for ever";

    add_plant(0);
    list(&horizon);
    EXPECT_EQ(list_.clouds().size(), 0u);
    EXPECT_EQ(list_.runs().size(), 0u);
    EXPECT_EQ(list_.hidden_tile_count, 1u);
    EXPECT_TRUE(is_wished(0, TileBlockKind::plants)) << "it would be forgotten and read again";
}

TEST_F(TileLists, FarBelowTheHorizonAStandInIsHiddenToo) {
    const Horizon horizon = horizon_of_a_wall(frustum_);
    add_tiles(std::array{tile_at(vec3(0, 2, -200), vec3(20, 4, 20))}, std::array{leaf(0)});
    list(&horizon);
    EXPECT_EQ(list_.clouds().size(), 0u);
    EXPECT_EQ(list_.hidden_tile_count, 1u);
    EXPECT_TRUE(list_.wishes().empty()) << "what is hidden is not read";
}

// Ten pixels beside the picture, to the left.
TEST_F(TileLists, AStandInIsOutsideWhereItsLargePointsAre) {
    const float border_m = 200.0f * 400.0f / frustum_.focal_px;
    const float ten_px_m = 200.0f * 10.0f / frustum_.focal_px;
    add_tiles(std::array{tile_at(vec3(-border_m - ten_px_m - 1.0f, 10, -200), vec3(2))}, std::array{leaf(0)});
    list(nullptr);
    EXPECT_EQ(list_.stand_in_count, 1u);
    add_plant(0);
    list(nullptr);
    EXPECT_EQ(list_.clouds().size() + list_.runs().size(), 0u);
}

// The one that is not in memory is behind the wall, but not so far that what stands for it is hidden.
TEST_F(TileLists, AParentStandsInUntilItsPointsAreHiddenWhereAChildIsMissing) {
    const Horizon horizon = horizon_of_a_wall(frustum_);
    const Tile shown = tile_at(vec3(-60, 60, -200), vec3(20)),
               missing = tile_at(vec3(60, 30, -200), vec3(20));
    const Tile parent = tile_at(vec3(0, 45, -200), vec3(140, 50, 20));
    const TileLevels levels{0, 1, 2, TileLevels::k_none, k_finest_density, 1, 2};
    add_tiles(std::array{parent, shown, missing}, std::array{levels, leaf(1), leaf(TileLevels::k_none)});
    list(&horizon);
    ASSERT_EQ(list_.clouds().size(), 1u);
    EXPECT_EQ(list_.clouds()[0].cloud, 0u);
    EXPECT_TRUE(is_wished(2, TileBlockKind::cloud)) << "it would stand there for ever";
}

TEST_F(TileLists, WhatIsWishedForDoesNotFollowFromWhatIsInMemory) {
    const Horizon horizon = horizon_of_a_wall(frustum_);
    const Tile shown = tile_at(vec3(-60, 60, -200), vec3(20)), hidden = tile_at(vec3(60, 30, -200), vec3(20));
    const Tile parent = tile_at(vec3(0, 45, -200), vec3(140, 50, 20));
    const TileLevels levels{0, 1, 2, TileLevels::k_none, k_finest_density, 1, 2};
    add_tiles(std::array{parent, shown, hidden}, std::array{levels, leaf(1), leaf(2)});
    for (bool in_memory : {false, true}) {
        if (in_memory) {
            add_plant(1);
            add_plant(2);
        }
        list(&horizon);
        EXPECT_EQ(list_.wishes().size(), 5u) << "three clouds and the plants of two";
        EXPECT_EQ(list_.clouds().size(), in_memory ? 0u : 2u);
        EXPECT_EQ(list_.runs().size(), in_memory ? 1u : 0u) << "only of the one that is shown";
    }
}

}  // namespace
}  // namespace coppice
