#include "plugins/vegetation/eco/tile_forest.h"

#include <algorithm>
#include <functional>
#include <map>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "tests/eco/cloud_plants.h"
#include "tests/eco/made_tiles.h"

namespace coppice {
namespace {

constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};

// A folder of populated scenes and mosaics, as `coppice populate` leaves them.
class Forest : public testing::Test {
  protected:
    Forest() : folder_("tile_forest_"), hand_(2) {
        Random random(5);
        for (uint32_t m = 0; m < 2; ++m) {
            roughen_gains(hand_[m].add_points(2000, 3.0f), random);
            roughen_gains(hand_[m].add_lines(std::vector<float>(300, 1.0f), 0.5f), random);
            plants_.push_back(hand_[m].view());
            plants_.back().triangle_vertices = std::span(triangles_).first(3 * (m + 1));
            plants_.back().content_hash = 100 + m;
        }
    }

    std::string path_of(const std::string& name) const { return folder_.path_of(name + ".json"); }

    static std::vector<Placement> scattered(uint32_t count, double side_m, uint64_t seed) {
        Random random(seed);
        std::vector<Placement> placements(count);
        for (Placement& p : placements) {
            const double x = double(random.next_in(-0.5f, 0.5f)) * side_m, y = double(random.next_in(0, 9));
            const double z = double(random.next_in(-0.5f, 0.5f)) * side_m;
            p = {dvec3(x, y, z), random.next_in(0.5f, 2.0f), pack_turn_about_y(random.next_in(0.0f, 6.28f)),
                 PlantModel{random.next_below(2), uint32_t(random.next_bits())}};
        }
        return placements;
    }

    Scene tiled(std::span<const Placement> placements) const {
        Scene scene;
        scene.models = {{"a", "plants/a.plant", 0, 1.0f}, {"b", "plants/b.plant", 0, 1.0f}};
        make_tiles(placements, scene);
        finish_tiles(scene, std::vector<Box>{plants_[0].bounds_plant, plants_[1].bounds_plant});
        return scene;
    }

    void write(const std::string& name, PopulatedScene populated) {
        populated.scene.name = name;
        if (populated.scene.camera_path.empty()) populated.scene.camera_path = {{0.0, Camera{}}};
        ASSERT_TRUE(write_text_file(path_of(name), write_populated_scene(populated)));
    }

    // In packs of so many tiles each.
    void write_scene(const std::string& name, std::span<const Placement> placements, size_t pack_tiles,
                     const std::string& terrain_json = "") {
        const Scene whole = tiled(placements);
        PopulatedScene populated;
        populated.scene.models = whole.models;
        populated.model_content_hashes = {100, 101};
        populated.terrain_json = terrain_json;
        for (size_t first = 0; first < whole.tiles.size(); first += pack_tiles) {
            Scene part = whole;
            const size_t last = std::min(first + pack_tiles, whole.tiles.size());
            part.tiles.assign(whole.tiles.begin() + ptrdiff_t(first), whole.tiles.begin() + ptrdiff_t(last));
            const std::string pack_name = fmt::format("{}-{}.tiles", name, populated.packs.size());
            const std::string path = folder_.path_of(pack_name);
            ASSERT_TRUE(write_tile_pack(path, build_tile_tree(part, plants_), part, plants_, 1));
            populated.packs.push_back({pack_name, open_tile_pack(path)->content_hash, 1, 1});
        }
        write(name, populated);
    }

    PlacedScene placed(const std::string& name, dvec3 at, uint32_t columns = 1, uint32_t rows = 1,
                       double spacing_m = 0.0) const {
        PlacedScene placed;
        placed.path = name + ".json";
        const auto text = read_text_file(path_of(name));
        if (text) placed.content_hash = hash_text(*text);
        placed.at = at;
        placed.columns = columns;
        placed.rows = rows;
        placed.spacing_m = spacing_m;
        return placed;
    }

    void write_mosaic(const std::string& name, std::vector<PlacedScene> places) {
        PopulatedScene populated;
        populated.mosaic = std::move(places);
        write(name, populated);
    }

    TileForest load(const std::string& name) const {
        auto forest = load_forest(path_of(name), &k_terrain);
        EXPECT_TRUE(forest) << (forest ? "" : to_string(forest.error()));
        return forest ? std::move(*forest) : TileForest{};
    }
    Error error_of(const std::string& name) const {
        const auto forest = load_forest(path_of(name), &k_terrain);
        EXPECT_FALSE(forest) << "accepted";
        return forest ? Error{} : forest.error();
    }

    ScratchFolder folder_;
    std::vector<HandPlant> hand_;
    std::vector<PackedVertex> triangles_{6};
    std::vector<Plant> plants_;
};

// Every rule of the contract that needs no walk.
void expect_sound(const TileForest& forest) {
    ASSERT_FALSE(forest.rows.empty());
    std::vector<int> named(forest.rows.size(), 0);
    named[0] = 1;
    for (uint32_t r = 0; r < forest.rows.size(); ++r) {
        const ForestRow& row = forest.rows[r];
        EXPECT_EQ(named[r] > 0, true) << "row " << r << " is below no row before it";
        EXPECT_LE((row.child_count > 0) + (row.target != k_no_row), 1);
        if (row.target != k_no_row) {
            ASSERT_GT(row.target, r);
            ASSERT_LT(row.target, forest.rows.size());
            ++named[row.target];
            EXPECT_EQ(row.plant_count, forest.rows[row.target].plant_count);
            EXPECT_EQ(row.triangle_count, forest.rows[row.target].triangle_count);
            EXPECT_EQ(row.finest_density, forest.rows[row.target].finest_density);
            EXPECT_EQ(row.cloud, k_no_row);
            EXPECT_EQ(row.pack, k_no_row);
            continue;
        }
        if (row.pack == k_no_row) {
            ASSERT_LT(row.cloud, forest.clouds.size());
        } else {
            ASSERT_LT(row.pack, forest.packs.size());
            ASSERT_LT(row.node, forest.packs[row.pack].nodes.size());
            EXPECT_EQ(row.cloud != k_no_row, row.node == 0) << "roots of packs alone are at hand";
        }
        if (row.child_count == 0) continue;
        ASSERT_GT(row.first_child, r);
        ASSERT_LE(row.first_child + row.child_count, forest.rows.size());
        uint64_t plants = 0, triangles = 0;
        for (uint32_t c = row.first_child; c < row.first_child + row.child_count; ++c) {
            EXPECT_EQ(named[c], 0) << "a child is nobody else's";
            ++named[c];
            plants += forest.rows[c].plant_count;
            triangles += forest.rows[c].triangle_count;
        }
        EXPECT_EQ(row.plant_count, plants);
        EXPECT_EQ(row.triangle_count, triangles);
    }
}

// All plants by every way down; `visit(foot in the world, scale, boxes on the way)`.
struct WorldBox {
    dvec3 low, high;
};
using Visit = std::function<void(dvec3, float, const std::vector<WorldBox>&)>;
void expand(const TileForest& forest, uint32_t r, dvec3 space, std::vector<WorldBox>& boxes,
            const Visit& visit) {
    const ForestRow& row = forest.rows[r];
    const dvec3 origin = space + row.origin;
    boxes.push_back({origin + dvec3(row.bounds_tile.min), origin + dvec3(row.bounds_tile.max)});
    if (row.target != k_no_row) expand(forest, row.target, origin, boxes, visit);
    for (uint32_t c = row.first_child; c < row.first_child + row.child_count; ++c)
        expand(forest, c, space, boxes, visit);
    if (row.target == k_no_row && row.child_count == 0 && row.pack != k_no_row) {
        const auto plants = read_plants(forest.packs[row.pack], row.node);
        ASSERT_TRUE(plants);
        for (const PlantPosition& p : plants->positions)
            visit(origin + dvec3(p.x_tile, p.y_tile, p.z_tile), p.scale, boxes);
    }
    boxes.pop_back();
}

TEST_F(Forest, ASceneOfOnePackIsItsTree) {
    const auto placements = scattered(3000, 300.0, 1);
    write_scene("wood", placements, 1000);
    const TileForest forest = load("wood");
    expect_sound(forest);
    ASSERT_EQ(forest.packs.size(), 1u);
    EXPECT_EQ(forest.rows.size(), forest.packs[0].nodes.size());
    EXPECT_EQ(forest.rows[0].plant_count, 3000u);
    EXPECT_EQ(forest.clouds.size(), 1u);
    EXPECT_TRUE(same_clouds(forest.clouds[0], *read_cloud(forest.packs[0], 0)));
    EXPECT_TRUE(forest.grounds.empty());
    EXPECT_EQ(forest.name, "wood");
    EXPECT_EQ(forest.models[1].source_path, folder_.path_of("plants/b.plant"));
    EXPECT_EQ(ground_height(forest, 3.0, 4.0), 0.0);
}

// 4 x 4 of 4 x 4 of 4 x 4: a thousand times the plants in a few rows more.
TEST_F(Forest, WhatStandsOftenIsHeldOnce) {
    const auto placements = scattered(5000, 400.0, 2);
    write_scene("wood", placements, 2);
    const TileForest one = load("wood");
    expect_sound(one);
    ASSERT_GE(one.packs.size(), 3u);
    uint64_t triangles = 0;
    for (const Placement& p : placements) triangles += p.model.model + 1;
    EXPECT_EQ(one.rows[0].plant_count, 5000u);
    EXPECT_EQ(one.rows[0].triangle_count, triangles);

    write_mosaic("mosaic 1", {placed("wood", dvec3(0.0), 4, 4, 400.0)});
    write_mosaic("mosaic 2", {placed("mosaic 1", dvec3(0.0), 4, 4, 1600.0)});
    write_mosaic("mosaic 3", {placed("mosaic 2", dvec3(0.0), 4, 4, 6400.0)});
    const TileForest all = load("mosaic 3");
    expect_sound(all);
    EXPECT_EQ(all.rows.size(), one.rows.size() + 3 * 17);
    EXPECT_EQ(all.packs.size(), one.packs.size());
    EXPECT_EQ(all.models.size(), 2u);
    EXPECT_EQ(all.clouds.size(), one.clouds.size() + 3);
    EXPECT_EQ(all.rows[0].plant_count, 4096u * 5000u);
    EXPECT_EQ(all.rows[0].triangle_count, 4096u * triangles);
    const vec3 size = all.rows[0].bounds_tile.size();
    EXPECT_GT(size.x, 63.0f * 400.0f);
    EXPECT_LT(size.x, 64.0f * 400.0f + 10.0f);
}

TEST_F(Forest, HoldsEveryPlantWithinAllBoundsOnItsWay) {
    const auto wood = scattered(4000, 300.0, 3), grove = scattered(700, 60.0, 4);
    write_scene("wood", wood, 1);
    write_scene("grove", grove, 100);
    const dvec3 far(1e6 + 0.0625, 0.0, -2e6);
    write_mosaic("inner", {placed("wood", dvec3(7.0, 0, -3.25), 2, 2, 301.5), placed("grove", far)});
    write_mosaic("outer", {placed("inner", dvec3(-5e5, 0, 0), 1, 2, 1e5), placed("grove", dvec3(0, 0, 900))});
    const TileForest forest = load("outer");
    expect_sound(forest);

    std::vector<dvec3> expected;
    auto add = [&expected](const std::vector<Placement>& placements, dvec3 at) {
        for (const Placement& p : placements) expected.push_back(at + p.position_world);
    };
    for (double inner_z : {-5e4, 5e4}) {
        const dvec3 inner(-5e5, 0, inner_z);
        for (double x : {-0.5, 0.5})
            for (double z : {-0.5, 0.5}) add(wood, inner + dvec3(7.0 + x * 301.5, 0, -3.25 + z * 301.5));
        add(grove, inner + far);
    }
    add(grove, dvec3(0, 0, 900));

    std::vector<dvec3> found;
    std::vector<WorldBox> boxes;
    size_t outside = 0;
    expand(forest, 0, dvec3(0.0), boxes, [&](dvec3 foot, float scale, const std::vector<WorldBox>& way) {
        found.push_back(foot);
        EXPECT_GE(way.size(), 3u);
        // What finish_tiles takes for a turned plant is more than the ball within its box.
        const dvec3 reach(scale);
        for (const WorldBox& box : way)
            outside += glm::any(glm::lessThan(foot - reach, box.low)) ||
                       glm::any(glm::greaterThan(foot + reach, box.high));
    });
    EXPECT_EQ(outside, 0u);
    ASSERT_EQ(found.size(), expected.size());
    auto before = [](const dvec3& a, const dvec3& b) {
        const double ax = std::floor(a.x * 64.0), bx = std::floor(b.x * 64.0);
        return ax != bx ? ax < bx : a.z < b.z;
    };
    std::sort(found.begin(), found.end(), before);
    std::sort(expected.begin(), expected.end(), before);
    size_t astray = 0;
    for (size_t i = 0; i < found.size(); ++i) {
        // Cells of 1/64 m may part what is equal but for rounding, so a neighbour in order will do.
        double nearest_m = INFINITY;
        for (size_t k = i < 40 ? 0 : i - 40; k < std::min(i + 40, found.size()); ++k)
            nearest_m = std::min(nearest_m, glm::length(found[i] - expected[k]));
        astray += nearest_m > 1e-3;
    }
    EXPECT_EQ(astray, 0u);
}

// The joined clouds are those of the same plants in one tree.
TEST_F(Forest, JoinedCloudsAreWhatOneTreeWouldHave) {
    const auto wood = scattered(4000, 300.0, 5);
    write_scene("wood", wood, 1);
    auto expect_same = [&](const TileForest& forest, const std::vector<Placement>& placements) {
        const Scene scene = tiled(placements);
        const TileNode whole = build_tile_tree(scene, plants_)[0];
        const TileCloud& cloud = forest.clouds[forest.rows[0].cloud];
        ASSERT_EQ(cloud.points.size(), k_cloud_points);
        EXPECT_EQ(cloud.densities, whole.cloud.densities);
        EXPECT_NEAR(cloud.finest_density() / whole.cloud.finest_density(), 1.0, 0.2);
        EXPECT_EQ(forest.rows[0].finest_density, cloud.finest_density());
        EXPECT_NEAR(cloud.part.area_m2 / whole.cloud.part.area_m2, 1.0, 1e-4);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(cloud.part.mean_color_linear[c], whole.cloud.part.mean_color_linear[c], 1e-4);
        // Where the points stand in the world: their mean, to a hundredth of what they span.
        auto mean = [](const TileCloud& points, dvec3 origin) {
            dvec3 sum(0.0);
            for (const PackedVertex& p : points.points) sum += dvec3(p.x_plant, p.y_plant, p.z_plant);
            return origin + sum / double(points.points.size());
        };
        const dvec3 away = mean(cloud, forest.rows[0].origin) - mean(whole.cloud, whole.origin_world);
        EXPECT_LT(glm::length(away), 0.01 * double(glm::length(whole.bounds_tile.size())));
    };
    const TileForest one = load("wood");
    ASSERT_GE(one.packs.size(), 4u);
    expect_same(one, wood);

    write_mosaic("mosaic", {placed("wood", dvec3(5000.0, 0, 0), 2, 2, 320.0)});
    std::vector<Placement> all;
    for (double x : {-160.0, 160.0})
        for (double z : {-160.0, 160.0})
            for (Placement p : wood) {
                p.position_world += dvec3(5000.0 + x, 0.0, z);
                all.push_back(p);
            }
    expect_same(load("mosaic"), all);
}

std::string flat(float size_m, float height_m, const char* color = "[0.2, 0.2, 0.2]", dvec3 center = {}) {
    return fmt::format(R"({{"flat": {{"size_m": {}, "cell_m": 4, "height_m": {}}}, "center": [{}, {}, {}],)"
                       R"( "ground": {{"meadow": {}, "dry_share": 0, "soil_share": 0, "variation": 0}}}})",
                       size_m, height_m, center.x, center.y, center.z, color);
}

TEST_F(Forest, GroundsWithoutGapsAreKnown) {
    const auto wood = scattered(50, 100.0, 6);
    write_scene("low", wood, 1, flat(128, 1));
    write_scene("high", wood, 1, flat(128, 5));
    write_scene("bare", wood, 1);
    const TileForest low = load("low");
    ASSERT_EQ(low.grounds.size(), 1u);
    EXPECT_EQ(low.rows[0].ground, 0u);
    EXPECT_TRUE(low.grounds[0].terrain);
    EXPECT_TRUE(low.grounds[0].without_gaps);
    EXPECT_EQ(low.grounds[0].bounds.min.x, -64.0f);
    EXPECT_EQ(ground_height(low, 1e3, 0.0), 1.0);

    auto of = [&](std::vector<PlacedScene> places) {
        write_mosaic("mosaic", std::move(places));
        TileForest forest = load("mosaic");
        expect_sound(forest);
        return forest;
    };
    const TileForest whole =
        of({placed("low", dvec3(-64, 0, 0), 1, 2, 128), placed("high", dvec3(64, 0, 0), 1, 2, 128)});
    ASSERT_EQ(whole.grounds.size(), 3u) << "its own, and one of each scene";
    EXPECT_EQ(whole.rows[0].ground, 0u);
    EXPECT_FALSE(whole.grounds[0].terrain);
    EXPECT_TRUE(whole.grounds[0].without_gaps);
    const Box& bounds = whole.grounds[0].bounds;
    EXPECT_EQ(vec2(bounds.min.x, bounds.min.z), vec2(-128));
    EXPECT_EQ(bounds.max, vec3(128, 5, 128));
    EXPECT_LE(bounds.min.y, 1.0f);
    EXPECT_EQ(ground_height(whole, -10.0, 100.0), 1.0);
    EXPECT_EQ(ground_height(whole, 10.0, -100.0), 5.0);
    EXPECT_EQ(ground_height(whole, 9e4, 9e4), 5.0);
    write_mosaic("inner",
                 {placed("low", dvec3(-64, 0, 0), 1, 2, 128), placed("high", dvec3(64, 0, 0), 1, 2, 128)});
    const TileForest nested = of({placed("inner", dvec3(1e5, 0, 0), 3, 1, 256)});
    EXPECT_TRUE(nested.grounds[0].without_gaps);
    EXPECT_EQ(ground_height(nested, 1e5 + 266.0, 100.0), 5.0);

    EXPECT_FALSE(of({placed("low", dvec3(0.0), 2, 2, 129)}).grounds[0].without_gaps) << "a gap";
    EXPECT_FALSE(of({placed("low", dvec3(0.0), 2, 2, 127)}).grounds[0].without_gaps) << "an overlap";
    EXPECT_FALSE(
        of({placed("low", dvec3(0.0), 3, 1, 128), placed("low", dvec3(0.0))}).grounds[0].without_gaps)
        << "two in one place";
    EXPECT_FALSE(of({placed("low", dvec3(0.0)), placed("bare", dvec3(128, 0, 0))}).grounds[0].without_gaps);
    // Three quarters and one of them twice add up to the square.
    EXPECT_FALSE(of({placed("low", dvec3(-64, 0, -64)), placed("low", dvec3(64, 0, -64)),
                     placed("low", dvec3(64, 0, 64)), placed("high", dvec3(64, 0, 64))})
                     .grounds[0]
                     .without_gaps);
    EXPECT_TRUE(of({placed("bare", dvec3(0.0), 2, 2, 128)}).grounds.empty());
}

TEST_F(Forest, GroundsHaveTheirMeanColour) {
    const auto wood = scattered(50, 30.0, 6);
    write_scene("red", wood, 1, flat(64, 1, "[0.4, 0.1, 0.1]"));
    write_scene("blue", wood, 1, flat(128, 1, "[0.1, 0.1, 0.4]"));
    const vec3 red = load("red").grounds[0].mean_color_linear,
               blue = load("blue").grounds[0].mean_color_linear;
    EXPECT_NEAR(red.x, 0.4f, 0.02f);
    EXPECT_NEAR(red.z, 0.1f, 0.02f);
    EXPECT_NEAR(blue.z, 0.4f, 0.02f);
    write_mosaic("mosaic", {placed("red", dvec3(0.0), 2, 1, 64), placed("blue", dvec3(0, 0, 128))});
    const vec3 both = load("mosaic").grounds[0].mean_color_linear, wanted = (2.0f * red + 4.0f * blue) / 6.0f;
    EXPECT_LT(glm::length(both - wanted), 1e-5f);
}

TEST_F(Forest, AScenesGroundStandsThereWithoutPlants) {
    write_scene("meadow", {}, 1, flat(128, 2, "[0.1, 0.3, 0.1]", dvec3(1000, 0, 0)));
    write_scene("wood", scattered(50, 100.0, 6), 1, flat(128, 1));
    write_scene("nothing", {}, 1);
    const TileForest meadow = load("meadow");
    ASSERT_EQ(meadow.rows.size(), 1u);
    EXPECT_EQ(meadow.rows[0].plant_count, 0u);
    EXPECT_EQ(meadow.rows[0].ground, 0u);
    EXPECT_GT(meadow.rows[0].finest_density, 1e30f) << "an empty cloud is all there ever is";
    EXPECT_TRUE(meadow.clouds[meadow.rows[0].cloud].points.empty());
    EXPECT_EQ(ground_height(meadow, 1000.0, 0.0), 2.0);
    EXPECT_TRUE(load("nothing").rows.empty());

    write_mosaic("both", {placed("wood", dvec3(0.0)), placed("meadow", dvec3(-872, 0, 0)),
                          placed("nothing", dvec3(0, 0, 500))});
    const TileForest both = load("both");
    expect_sound(both);
    EXPECT_EQ(both.rows[0].child_count, 2u);
    EXPECT_EQ(both.rows[0].plant_count, 50u);
    const float finest = both.rows[0].finest_density;
    EXPECT_TRUE(finest > 0.0f && finest < 1e30f);
    EXPECT_EQ(ground_height(both, 128.0, 0.0), 2.0);
    EXPECT_FALSE(both.grounds[0].without_gaps) << "nothing has no ground";
    write_mosaic("meadows", {placed("meadow", dvec3(0.0), 2, 2, 128)});
    const TileForest meadows = load("meadows");
    expect_sound(meadows);
    EXPECT_GT(meadows.rows[0].finest_density, 1e30f);
    EXPECT_TRUE(meadows.grounds[0].without_gaps);
    write_mosaic("nowhere", {placed("nothing", dvec3(0.0), 2, 2, 128)});
    EXPECT_TRUE(load("nowhere").rows.empty());
}

TEST_F(Forest, ModelsOfAllScenesAreKnownByTheirPlants) {
    write_scene("a", scattered(50, 100.0, 6), 1);
    write_scene("b", scattered(60, 100.0, 7), 1);
    auto swapped = load_populated_scene(path_of("b"), &k_terrain);
    ASSERT_TRUE(swapped);
    write_mosaic("same", {placed("a", dvec3(0.0)), placed("b", dvec3(200, 0, 0))});
    const TileForest same = load("same");
    EXPECT_EQ(same.models.size(), 2u);
    EXPECT_EQ(same.first_model, (std::vector<uint32_t>{0, 0}));

    // The same plants, one of them more important.
    swapped->scene.models[1].importance = 2.0f;
    swapped->packs[0].path = "b-0.tiles";
    for (SceneModel& model : swapped->scene.models) model.source_path = "plants/b.plant";
    write("c", *swapped);
    write_mosaic("other",
                 {placed("a", dvec3(0.0)), placed("c", dvec3(200, 0, 0)), placed("b", dvec3(400, 0, 0))});
    const TileForest other = load("other");
    EXPECT_EQ(other.models.size(), 4u);
    EXPECT_EQ(other.first_model, (std::vector<uint32_t>{0, 2, 0}));
    EXPECT_EQ(other.models[3].importance, 2.0f);
    EXPECT_EQ(other.model_content_hashes, (std::vector<uint64_t>{100, 101, 100, 101}));
}

TEST_F(Forest, SaysWhatIsMissingOrBroken) {
    write_scene("wood", scattered(3000, 300.0, 1), 1);
    write_mosaic("mosaic", {placed("wood", dvec3(0.0), 2, 2, 300)});
    expect_sound(load("mosaic"));
    const std::string pack = folder_.path_of("wood-1.tiles"), sound = *read_text_file(pack);
    const uint64_t cloud_at = open_tile_pack(pack)->nodes[0].cloud.offset_bytes;
    std::string broken = sound;
    broken[cloud_at + 9] ^= 1;
    ASSERT_TRUE(write_text_file(pack, broken));
    Error error = error_of("mosaic");
    EXPECT_EQ(error.id, ErrorId::file_corrupt);
    EXPECT_EQ(error.file, pack);
    EXPECT_EQ(error.place, "node 0, cloud");
    std::filesystem::remove(pack);
    EXPECT_EQ(error_of("mosaic").id, ErrorId::file_missing);
    ASSERT_TRUE(write_text_file(pack, sound));

    ASSERT_TRUE(write_text_file(path_of("wood"), *read_text_file(path_of("wood")) + " "));
    error = error_of("mosaic");
    EXPECT_EQ(error.id, ErrorId::file_corrupt);
    EXPECT_EQ(error.file, path_of("wood")) << "another scene than the mosaic's";
    std::filesystem::remove(path_of("wood"));
    EXPECT_EQ(error_of("mosaic").id, ErrorId::file_missing);
}

TEST_F(Forest, RefusesMosaicsThatCannotStand) {
    write_scene("wood", scattered(50, 100.0, 1), 1);
    // The hash of a file that names itself cannot be had, but the way round is refused before.
    write_mosaic("b", {placed("wood", dvec3(0.0)), placed("a", dvec3(200, 0, 0))});
    write_mosaic("a", {placed("b", dvec3(0.0))});
    const Error cyclic = error_of("a");
    EXPECT_EQ(cyclic.id, ErrorId::value_out_of_range);
    EXPECT_EQ(cyclic.file, path_of("b"));
    EXPECT_EQ(cyclic.place, "mosaic[1].scene");
    EXPECT_EQ(cyclic.fault,
              "a scene in itself: " + path_of("a") + " -> " + path_of("b") + " -> " + path_of("a"));

    std::string below = "wood";
    for (int depth = 1; depth <= 17; ++depth) {
        const std::string name = fmt::format("depth {}", depth);
        write_mosaic(name, {placed(below, dvec3(0.0))});
        below = name;
    }
    expect_sound(load("depth 16"));
    EXPECT_EQ(error_of("depth 17").id, ErrorId::limit_exceeded);
    write_mosaic("known before", {placed("depth 16", dvec3(0.0))});
    EXPECT_EQ(error_of("known before").id, ErrorId::limit_exceeded);

    below = "wood";
    for (int depth = 1; depth <= 11; ++depth) {
        const std::string name = fmt::format("many {}", depth);
        write_mosaic(name, {placed(below, dvec3(0.0), 8, 8, 0.125)});
        below = name;
    }
    const TileForest many = load("many 9");
    EXPECT_EQ(many.rows[0].plant_count, 50u * (uint64_t(1) << 54));
    EXPECT_EQ(error_of("many 11").id, ErrorId::limit_exceeded);

    write_mosaic("far 1", {placed("wood", dvec3(3e9, 0, 0))});
    write_mosaic("far 2", {placed("far 1", dvec3(3e9, 0, 0))});
    EXPECT_EQ(error_of("far 2").id, ErrorId::value_out_of_range);
}

TEST_F(Forest, MosaicsAreReadStrictly) {
    using nlohmann::json;
    write_scene("wood", scattered(50, 100.0, 1), 1);
    write_mosaic("mosaic", {placed("wood", dvec3(0.25, 0, -3), 2, 2, 128.0)});
    auto populated = load_populated_scene(path_of("mosaic"), nullptr);
    ASSERT_TRUE(populated);
    EXPECT_EQ(populated->mosaic[0].path, path_of("wood"));
    populated->mosaic[0].path = "wood.json";
    EXPECT_EQ(write_populated_scene(*populated), *read_text_file(path_of("mosaic")));

    const json sound = json::parse(*read_text_file(path_of("mosaic")));
    auto error_after = [&](const std::function<void(json&)>& change) {
        json changed = sound;
        change(changed);
        EXPECT_TRUE(write_text_file(path_of("changed"), changed.dump()));
        return error_of("changed");
    };
    auto place_after = [&](const std::function<void(json&)>& change) { return error_after(change).place; };
    EXPECT_EQ(place_after([](json& j) { j["mosaic"] = json::array(); }), "mosaic");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0].erase("content"); }), "mosaic[0].content");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0]["content"] = "x"; }), "mosaic[0].content");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0].erase("scene"); }), "mosaic[0].scene");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0]["at"][1] = 1e10; }), "mosaic[0].at");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0]["grid"]["columns"] = 4294967296; }),
              "mosaic[0].grid.columns");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0]["grid"]["columns"] = 33; }), "mosaic");
    EXPECT_EQ(place_after([](json& j) { j["mosaic"][0]["grid"]["spacing_m"] = 0.1; }), "mosaic[0].grid");
    EXPECT_EQ(error_after([](json& j) { j["mosaic"][0]["turn_deg"] = 90; }).id, ErrorId::name_unknown);
    EXPECT_EQ(error_after([](json& j) { j["packs"] = json::array(); }).id, ErrorId::name_unknown);
    EXPECT_EQ(error_after([](json& j) { j["terrain"] = json::object(); }).id, ErrorId::name_unknown);
}

}  // namespace
}  // namespace coppice
