#include "plugins/vegetation/eco/tile_tree.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/make_tiles.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/eco/cloud_plants.h"

namespace coppice {
namespace {

std::vector<HandPlant> hand_plants() {
    Random random(5);
    std::vector<HandPlant> plants(3);
    for (uint32_t m = 0; m < 3; ++m) {
        roughen_gains(plants[m].add_points(2000, 3.0f), random);
        roughen_gains(plants[m].add_lines(std::vector<float>(300, 1.0f), 0.5f), random);
    }
    return plants;
}

std::vector<Plant> views_of(const std::vector<HandPlant>& plants) {
    std::vector<Plant> views;
    for (const HandPlant& plant : plants) views.push_back(plant.view());
    return views;
}

// Denser towards one corner, far from the world's origin.
Scene wood(uint32_t count, double side_m, const std::vector<Plant>& plants, uint64_t seed) {
    Random random(seed);
    std::vector<Placement> placements(count);
    for (uint32_t i = 0; i < count; ++i) {
        Placement& p = placements[i];
        const double x_m = double(random.next_unit()) * side_m, y_m = double(random.next_in(0.0f, 30.0f));
        const double z_m = double(random.next_unit() * random.next_unit()) * side_m;
        p.position_world = dvec3(1e6 + x_m, y_m, -3e6 + z_m);
        p.scale = random.next_in(0.5f, 2.0f);
        p.turn = pack_turn_about_y(random.next_in(0.0f, 6.28f));
        p.model = {random.next_below(uint32_t(plants.size())), uint32_t(random.next_bits())};
    }
    Scene scene;
    scene.models.resize(plants.size());
    make_tiles(placements, scene);
    std::vector<Box> bounds;
    for (const Plant& plant : plants) bounds.push_back(plant.bounds_plant);
    finish_tiles(scene, bounds);
    return scene;
}

// Every rule of the contract; the deepest leaf's depth.
uint32_t expect_sound(const std::vector<TileNode>& nodes, const Scene& scene) {
    std::vector<int> seen(scene.tiles.size(), 0), reached(nodes.size(), 0);
    std::vector<uint32_t> depth(nodes.size(), 0);
    uint32_t deepest = 0, next_child = 1;
    for (uint32_t n = 0; n < nodes.size(); ++n) {
        const TileNode& node = nodes[n];
        deepest = std::max(deepest, depth[n]);
        EXPECT_TRUE(std::is_sorted(node.cloud.densities.begin(), node.cloud.densities.end()));
        EXPECT_EQ(node.cloud.part.point_count, node.cloud.points.size());
        if (node.child_count == 0) {
            if (node.tile >= scene.tiles.size()) {
                ADD_FAILURE() << "a leaf without a tile";
                continue;
            }
            ++seen[node.tile];
            EXPECT_EQ(node.origin_world, scene.tiles[node.tile].tile.origin_world);
            EXPECT_EQ(node.plant_count, scene.tiles[node.tile].plant_count);
            continue;
        }
        EXPECT_EQ(node.tile, UINT32_MAX);
        EXPECT_GE(node.child_count, 2u);
        EXPECT_LE(node.child_count, 8u);
        EXPECT_EQ(node.first_child, next_child) << "children follow each other, and come after their parents";
        next_child += node.child_count;
        uint64_t plants = 0;
        for (uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
            ++reached[c];
            depth[c] = depth[n] + 1;
            plants += nodes[c].plant_count;
            const dvec3 low = nodes[c].origin_world + dvec3(nodes[c].bounds_tile.min),
                        high = nodes[c].origin_world + dvec3(nodes[c].bounds_tile.max);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LE(node.origin_world[axis] + double(node.bounds_tile.min[axis]), low[axis]);
                EXPECT_GE(node.origin_world[axis] + double(node.bounds_tile.max[axis]), high[axis]);
            }
        }
        EXPECT_EQ(node.plant_count, plants);
        for (int axis = 0; axis < 3; ++axis) {
            const double sixteenths = node.origin_world[axis] * 16.0;
            EXPECT_EQ(sixteenths, std::floor(sixteenths));
        }
    }
    for (size_t t = 0; t < seen.size(); ++t) EXPECT_EQ(seen[t], scene.tiles[t].plant_count > 0 ? 1 : 0);
    for (size_t n = 1; n < nodes.size(); ++n) EXPECT_EQ(reached[n], 1);
    return deepest;
}

TEST(TileTree, HoldsEveryTileOnce) {
    const auto hand = hand_plants();
    const auto plants = views_of(hand);
    const Scene scene = wood(40000, 2000.0, plants, 1);
    ASSERT_GT(scene.tiles.size(), 60u);
    const auto nodes = build_tile_tree(scene, plants);
    EXPECT_LE(expect_sound(nodes, scene), 9u);
    EXPECT_EQ(nodes.front().plant_count, 40000u);
    EXPECT_LT(nodes.size(), 2 * scene.tiles.size());
    // Neighbours: the nodes of a level hardly overlap, where children taken at random would each span the scene.
    const vec3 whole = nodes.front().bounds_tile.size();
    double children_m2 = 0.0;
    for (uint32_t c = nodes.front().first_child; c < nodes.front().first_child + nodes.front().child_count;
         ++c)
        for (uint32_t g = nodes[c].first_child; g < nodes[c].first_child + nodes[c].child_count; ++g) {
            const vec3 size = nodes[g].bounds_tile.size();
            children_m2 += double(size.x) * double(size.z);
        }
    EXPECT_LT(children_m2, 1.2 * double(whole.x) * double(whole.z));
}

TEST(TileTree, ParentsShowThePlantsOfTheirChildrenFirstThingsFirst) {
    const auto hand = hand_plants();
    const auto plants = views_of(hand);
    const Scene scene = wood(12000, 800.0, plants, 2);
    const auto nodes = build_tile_tree(scene, plants);
    ASSERT_GT(nodes.size(), 10u);
    for (const TileNode& node : nodes) {
        ASSERT_EQ(node.cloud.points.size(), k_cloud_points);
        if (node.child_count == 0) continue;
        // As many as the children have up to that density, and less fine than any of them.
        const float last = node.cloud.densities.back();
        size_t of_children = 0, tied = 0;
        for (uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
            const std::vector<float>& densities = nodes[c].cloud.densities;
            EXPECT_LE(node.cloud.finest_density(), nodes[c].cloud.finest_density());
            of_children +=
                size_t(std::upper_bound(densities.begin(), densities.end(), last) - densities.begin());
            tied += size_t(std::count(densities.begin(), densities.end(), last));
        }
        EXPECT_GE(of_children, k_cloud_points);
        EXPECT_LE(of_children, k_cloud_points + tied);
    }
    // The root's points stand in the world where the plants stand.
    const TileNode& root = nodes.front();
    for (size_t i = 0; i < root.cloud.points.size(); i += 97) {
        const PackedVertex& p = root.cloud.points[i];
        const vec3 at(p.x_plant, p.y_plant, p.z_plant);
        ASSERT_TRUE(glm::all(glm::lessThanEqual(root.bounds_tile.min, at)) &&
                    glm::all(glm::lessThanEqual(at, root.bounds_tile.max)));
        const dvec3 world = root.origin_world + dvec3(at);
        bool near_a_plant = false;
        for (const SceneTile& tile : scene.tiles)
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count && !near_a_plant;
                 ++row) {
                const PlantPosition& foot = scene.positions[row];
                const dvec3 away =
                    world - tile.tile.origin_world - dvec3(foot.x_tile, foot.y_tile, foot.z_tile);
                near_a_plant = glm::length(away) < 1.8 * double(foot.scale);
            }
        ASSERT_TRUE(near_a_plant);
    }
}

TEST(TileTree, OfOneTileIsALeafAndOfNoneIsEmpty) {
    const auto hand = hand_plants();
    const auto plants = views_of(hand);
    EXPECT_TRUE(build_tile_tree(Scene{}, plants).empty());
    Scene scene = wood(100, 50.0, plants, 3);
    ASSERT_EQ(scene.tiles.size(), 1u);
    scene.tiles.insert(scene.tiles.begin(), SceneTile{});  // without plants
    const auto nodes = build_tile_tree(scene, plants);
    ASSERT_EQ(nodes.size(), 1u);
    EXPECT_EQ(nodes[0].tile, 1u);
    EXPECT_EQ(expect_sound(nodes, scene), 0u);
}

TEST(TileTree, ManyTilesInOnePlaceAreShallow) {
    const auto hand = hand_plants();
    const auto plants = views_of(hand);
    std::vector<Placement> placements(100 * k_tile_plant_limit,
                                      Placement{dvec3(1, 2, 3), 1.0f, {0, 0, 0, 32767}, {0, 0}});
    Scene scene;
    scene.models.resize(1);
    make_tiles(placements, scene);
    ASSERT_EQ(scene.tiles.size(), 100u);
    scene.tiles.resize(10);
    EXPECT_EQ(expect_sound(build_tile_tree(scene, plants), scene), 2u);
}

TEST(TileTree, SameOnAnyNumberOfThreads) {
    const auto hand = hand_plants();
    const auto plants = views_of(hand);
    const Scene scene = wood(6000, 500.0, plants, 4);
    auto hash_of_tree = [&] {
        uint64_t hash = 0;
        for (const TileNode& node : build_tile_tree(scene, plants)) {
            hash = hash_bytes(&node.origin_world, sizeof node.origin_world, hash);
            hash = hash_bytes(&node.bounds_tile, sizeof node.bounds_tile, hash);
            const uint32_t numbers[] = {node.first_child, node.child_count, node.tile, node.plant_count};
            hash = hash_bytes(numbers, sizeof numbers, hash);
            hash = hash_bytes(&node.cloud.part, sizeof node.cloud.part, hash);
            hash =
                hash_bytes(node.cloud.points.data(), node.cloud.points.size() * sizeof(PackedVertex), hash);
            hash = hash_span(std::span<const float>(node.cloud.densities), hash);
            hash = hash_span(std::span<const float>(node.cloud.exhausted_area_m2), hash);
        }
        return hash;
    };
    set_thread_limit(1);
    const uint64_t one = hash_of_tree();
    set_thread_limit(0);
    EXPECT_EQ(one, hash_of_tree());
}

}  // namespace
}  // namespace coppice
