#include "plugins/vegetation/eco/make_tiles.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/shade_ground.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

std::vector<Placement> plants_over(size_t count, double side_m, uint64_t seed) {
    Random random(seed);
    std::vector<Placement> plants(count);
    for (size_t i = 0; i < count; ++i) {
        Placement& p = plants[i];
        p.position_world.x = 1e6 + double(random.next_unit()) * side_m;
        p.position_world.y = double(random.next_unit()) * 50.0;
        p.position_world.z = -2e6 + double(random.next_unit() * random.next_unit()) * side_m;
        p.scale = random.next_in(0.5f, 2.0f);
        p.turn = pack_turn(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1),
                           random.next_in(-1, 1));
        p.model = {random.next_below(3), uint32_t(i)};  // the seed tells which plant it was
    }
    return plants;
}

Scene scene_of(const std::vector<Placement>& plants) {
    Scene scene;
    scene.models.resize(3);
    make_tiles(plants, scene);
    return scene;
}

vec3 turned(PlantTurn turn, vec3 v) {
    vec3 q(turn.x / 32767.0f, turn.y / 32767.0f, turn.z / 32767.0f);
    vec3 t = 2.0f * glm::cross(q, v);
    return v + t * (turn.w / 32767.0f) + glm::cross(q, t);
}

TEST(MakeTiles, EveryPlantIsInExactlyOneTile) {
    auto plants = plants_over(30000, 3000.0, 1);
    Scene scene = scene_of(plants);
    std::vector<int> seen(plants.size(), 0);
    uint32_t next = 0;
    for (const SceneTile& tile : scene.tiles) {
        EXPECT_EQ(tile.first_plant, next);
        next += tile.plant_count;
        EXPECT_GT(tile.plant_count, 0u);
        EXPECT_LE(tile.plant_count, k_tile_plant_limit);
        for (uint32_t row = tile.first_plant; row < next; ++row) {
            uint32_t plant = scene.plant_models[row].seed;
            ++seen[plant];
            const PlantPosition& p = scene.positions[row];
            dvec3 world = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
            ASSERT_LT(glm::length(world - plants[plant].position_world), 2e-4);
            ASSERT_EQ(p.scale, plants[plant].scale);
            ASSERT_EQ(scene.plant_models[row].model, plants[plant].model.model);
            if (row > tile.first_plant) {
                ASSERT_LE(scene.plant_models[row - 1].model, scene.plant_models[row].model);
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            double sixteenths = tile.tile.origin_world[axis] * 16.0;
            EXPECT_EQ(sixteenths, std::floor(sixteenths));
        }
    }
    EXPECT_EQ(next, plants.size());
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    EXPECT_LT(scene.tiles.size(), 300u);  // and not one tile a plant
}

TEST(MakeTiles, TilesAreSquaresThatDoNotOverlap) {
    Scene scene = scene_of(plants_over(20000, 1000.0, 2));
    for (size_t a = 0; a < scene.tiles.size(); ++a)
        for (size_t b = a + 1; b < scene.tiles.size(); ++b) {
            const Tile &s = scene.tiles[a].tile, &t = scene.tiles[b].tile;
            auto apart = [&](int axis) {
                return s.origin_world[axis] + double(s.bounds_tile.max[axis]) <=
                           t.origin_world[axis] + double(t.bounds_tile.min[axis]) + 1e-3 ||
                       t.origin_world[axis] + double(t.bounds_tile.max[axis]) <=
                           s.origin_world[axis] + double(s.bounds_tile.min[axis]) + 1e-3;
            };
            ASSERT_TRUE(apart(0) || apart(2));
        }
}

TEST(MakeTiles, FinishedBoundsHoldEveryPlant) {
    auto plants = plants_over(5000, 400.0, 3);
    Scene scene = scene_of(plants);
    std::vector<Box> bounds{
        {vec3(-1, 0, -2), vec3(3, 9, 1)}, {vec3(-0.2f, -0.1f, -0.2f), vec3(0.1f, 0.3f, 0.1f)}, {}};
    finish_tiles(scene, bounds);
    for (const SceneTile& tile : scene.tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = scene.positions[row];
            Box box = bounds[scene.plant_models[row].model];
            if (box.empty()) box = {vec3(0), vec3(0)};
            for (int corner = 0; corner < 8; ++corner) {
                vec3 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                        corner & 4 ? box.max.z : box.min.z);
                vec3 away = turned(scene.turns[row], at) * p.scale;
                vec3 local = vec3(p.x_tile, p.y_tile, p.z_tile) + away;
                ASSERT_TRUE(glm::all(glm::lessThanEqual(tile.tile.bounds_tile.min, local)) &&
                            glm::all(glm::lessThanEqual(local, tile.tile.bounds_tile.max)));
            }
        }
}

TEST(MakeTiles, ManyPlantsOnOneSpotShareItOverTiles) {
    std::vector<Placement> plants(3000, Placement{dvec3(1, 2, 3), 1.0f, {0, 0, 0, 32767}, {0, 0}});
    Scene scene = scene_of(plants);
    ASSERT_EQ(scene.tiles.size(), 3u);
    EXPECT_EQ(scene.tiles[2].plant_count, 3000u - 2048u);
    EXPECT_TRUE(scene_of({}).tiles.empty());
}

TEST(MakeTiles, SameOnAnyNumberOfThreads) {
    auto plants = plants_over(100000, 2000.0, 4);
    auto hash = [&] {
        Scene scene = scene_of(plants);
        return hash_bytes(
            scene.positions.data(), scene.positions.size() * sizeof(PlantPosition),
            hash_bytes(scene.plant_models.data(), scene.plant_models.size() * sizeof(PlantModel)));
    };
    set_thread_limit(1);
    uint64_t one = hash();
    set_thread_limit(0);
    EXPECT_EQ(one, hash());
}

class CountingTerrain final : public Terrain {
  public:
    dvec3 origin_world() const override { return dvec3(1e6, 0, -2e6); }
    Box bounds_local() const override { return {}; }
    float height_at(float, float) const override { return 0.0f; }
    vec3 normal_at(float, float) const override { return vec3(0, 1, 0); }
    std::span<const TerrainPatch> patches() const override { return {}; }
    std::span<const TerrainLevel> levels() const override { return {}; }
    std::span<const PackedVertex> vertices() const override { return {}; }
    uint32_t vertex_count() const override { return 0; }
    void write_vertices(std::span<PackedVertex>) const override {}
    void write_level(uint32_t, std::span<PackedVertex>) const override {}
    void shade(float x, float z, float radius_m, float amount) override {
        calls.push_back({x, z, radius_m, amount});
    }
    std::vector<vec4> calls;
};

TEST(ShadeGround, CrownsDarkenAwayFromTheSunAndHerbsDoNot) {
    std::vector<Placement> plants{{dvec3(1e6 + 10, 0, -2e6 + 20), 1.0f, {0, 0, 0, 32767}, {0, 0}},
                                  {dvec3(1e6 + 30, 0, -2e6 + 20), 1.0f, {0, 0, 0, 32767}, {1, 0}}};
    Scene scene = scene_of(plants);
    scene.light.direction_to_sun = vec3(1, 1, 0);
    std::vector<Box> bounds{
        {vec3(-3, 0, -3), vec3(3, 12, 3)}, {vec3(-0.2f, 0, -0.2f), vec3(0.2f, 0.4f, 0.2f)}, {}};
    CountingTerrain terrain;
    shade_ground(scene, terrain, bounds);
    ASSERT_EQ(terrain.calls.size(), 1u);
    EXPECT_LT(terrain.calls[0].x, 9.5f);
    EXPECT_GT(terrain.calls[0].x, 10.0f - 3.0f);
    EXPECT_NEAR(terrain.calls[0].y, 20.0f, 0.01f);
    EXPECT_NEAR(terrain.calls[0].z, 3.0f, 0.5f);
    EXPECT_GT(terrain.calls[0].w, 0.4f);
}

}  // namespace
}  // namespace coppice
