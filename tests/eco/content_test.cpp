// The scenes that come with the program can be read, and hold what they say.
#include <algorithm>
#include <filesystem>
#include <set>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/mosaic_tree.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

Scene load_content(const std::string& name) {
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    static constexpr ModellerInterface k_modeller{sizeof(ModellerInterface), modeller::grow_plant};
    auto scene = load_scene(COPPICE_CONTENT_DIR "/scenes/" + name + ".eco.json", {&k_terrain, &k_modeller});
    EXPECT_TRUE(scene) << (scene ? "" : to_string(scene.error()));
    return scene ? std::move(*scene) : Scene{};
}

TEST(Content, PinesAre640) {
    Scene scene = load_content("pines");
    EXPECT_EQ(scene.positions.size(), 640u);
    EXPECT_EQ(scene.models.size(), 5u);
}

TEST(Content, PalmsAre1500) {
    Scene scene = load_content("palms");
    EXPECT_EQ(scene.positions.size(), 1500u);
    EXPECT_EQ(scene.models.size(), 5u);
}

TEST(Content, SunflowersAre13000AndATree) {
    Scene scene = load_content("sunflowers");
    auto count = [&](const char* name) {
        return std::count_if(scene.plant_models.begin(), scene.plant_models.end(),
                             [&](const PlantModel& plant) { return scene.models[plant.model].name == name; });
    };
    EXPECT_EQ(count("sunflower"), 13000);
    EXPECT_EQ(count("lime"), 1);
    // A hundred individuals as four models: a field of many sizes from few shapes.
    EXPECT_EQ(std::ranges::count(scene.models, "sunflower", &SceneModel::name), 4);
}

TEST(Content, LandscapeIsMixedFromScenesThatShareTheirModels) {
    Scene scene = load_content("landscape");
    std::set<std::string> names, sources;
    for (const PlantModel& plant : scene.plant_models) names.insert(scene.models[plant.model].name);
    for (const char* name : {"oak", "birch", "pine", "beech", "shrub", "fern", "grass", "daisy"})
        EXPECT_TRUE(names.count(name)) << name;
    EXPECT_GT(scene.positions.size(), 50000u);
    for (const SceneModel& model : scene.models)
        EXPECT_TRUE(sources.insert(model.source_path + std::to_string(model.variation)).second)
            << model.source_path;
}

// Nothing floats and nothing is buried: an author's heights are the ground's.
TEST(Content, PlantsStandOnTheGround) {
    for (const char* name : {"palms", "sunflowers", "landscape"}) {
        Scene scene = load_content(name);
        for (const SceneTile& tile : scene.tiles)
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
                const PlantPosition& p = scene.positions[row];
                dvec3 at = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
                ASSERT_NEAR(at.y, double(scene.terrain->height_at(float(at.x), float(at.z))), 0.01) << name;
            }
    }
}

// A square that stands beside itself: as many plants at its borders as elsewhere, none of them off its ground.
TEST(Content, TheContinentsRegionGoesOnBeyondItsBorders) {
    Scene scene = load_content("continent/region");
    ASSERT_TRUE(scene.terrain);
    constexpr double k_side_m = 4096.0, k_strip_m = 128.0;
    const TerrainLayout layout = scene.terrain->layout();
    EXPECT_EQ(double(layout.cells_x) * double(layout.cell_m), k_side_m);
    EXPECT_GT(scene.positions.size(), 600000u);
    EXPECT_LT(scene.positions.size(), 1000000u);
    double at_borders = 0.0, in_the_middle = 0.0;
    for (const SceneTile& tile : scene.tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = scene.positions[row];
            const dvec3 at = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
            const double out = std::max(std::abs(at.x), std::abs(at.z));
            ASSERT_LE(out, 0.5 * k_side_m + 0.01);
            ASSERT_NEAR(at.y, double(scene.terrain->height_at(float(at.x), float(at.z))), 0.02);
            if (p.scale < 0.3f) continue;
            at_borders += out > 0.5 * k_side_m - k_strip_m;
            in_the_middle += out < 0.5 * k_side_m - k_strip_m;
        }
    const double inner_m = k_side_m - 2.0 * k_strip_m;
    const double share =
        at_borders / (k_side_m * k_side_m - inner_m * inner_m) / (in_the_middle / (inner_m * inner_m));
    EXPECT_GT(share, 0.6);
    EXPECT_LT(share, 1.4);
    for (float x = -2048.0f; x < 2048.0f; x += 61.0f) {
        EXPECT_EQ(scene.terrain->height_at(x, -2048.0f), scene.terrain->height_at(x, 2048.0f));
        EXPECT_EQ(scene.terrain->height_at(-2048.0f, x), scene.terrain->height_at(2048.0f, x));
    }
}

TEST(Content, TheContinentIsMoreThanAThousandRegions) {
    auto tree = read_mosaic_tree(COPPICE_CONTENT_DIR "/scenes/continent.eco.json");
    ASSERT_TRUE(tree) << to_string(tree.error());
    EXPECT_EQ(tree->nodes.size(), 4u);
    EXPECT_EQ(tree->root().scene_count, 1024u);
    EXPECT_EQ(tree->root().depth, 3u);

    // Its flight over the ground of its regions, which repeats.
    Scene region = load_content("continent/region");
    auto ground = [&](double x, double z) {
        auto local = [](double at) { return at - 4096.0 * std::floor(at / 4096.0) - 2048.0; };
        return ground_height(region.terrain.get(), local(x), local(z));
    };
    auto path = load_camera_path(COPPICE_CONTENT_DIR "/paths/continent.json", GroundHeight(ground));
    ASSERT_TRUE(path) << to_string(path.error());
    double fastest = 0.0, highest = 0.0;
    dvec3 before = path->front().camera.position_world;
    for (double time = 0.0; time <= path->back().time_s; time += 0.05) {
        dvec3 at = camera_at(*path, time).position_world;
        const double above = at.y - ground(at.x, at.z);
        ASSERT_GT(above, time > 25.0 && time < 142.0 ? 25.0 : 0.6) << time;
        if (above < 120.0) fastest = std::max(fastest, glm::length(at - before) / 0.05);
        highest = std::max(highest, above);
        before = at;
    }
    EXPECT_GT(fastest, 95.0);
    EXPECT_GT(highest, 4000.0);
}

TEST(Content, StandsHaveTheirTrees) {
    EXPECT_EQ(load_content("stand_640").positions.size(), 640u);
    EXPECT_EQ(load_content("stand_5000").positions.size(), 5000u);
    EXPECT_EQ(load_content("stand_50000").positions.size(), 50000u);
    EXPECT_EQ(load_content("thicket_100000").positions.size(), 100000u);
}

TEST(Content, WoodlandIsMixed) {
    Scene scene = load_content("woodland");
    std::set<std::string> names;
    for (const PlantModel& plant : scene.plant_models) names.insert(scene.models[plant.model].name);
    for (const char* name : {"oak", "birch", "pine", "shrub", "grass", "daisy", "sunflower"})
        EXPECT_TRUE(names.count(name)) << name;
    EXPECT_GT(scene.positions.size(), 20000u);
}

TEST(Content, FlightsStayAboveGround) {
    for (const char* name : {"woodland", "palms", "sunflowers", "landscape", "continent/region"}) {
        Scene scene = load_content(name);
        ASSERT_GE(scene.camera_path.back().time_s, 20.0);
        for (double time = 0.0; time <= scene.camera_path.back().time_s; time += 0.05) {
            dvec3 at = camera_at(scene.camera_path, time).position_world;
            ASSERT_GT(at.y, double(scene.terrain->height_at(float(at.x), float(at.z))) + 0.6)
                << name << " " << time;
        }
    }
}

// What `coppice bench accuracy` looks at: six views of each scene, from inside to far above.
TEST(Content, ViewsGoWithTheirScenes) {
    for (const char* name : {"pines", "woodland", "palms", "sunflowers", "landscape"}) {
        Scene scene = load_content(name);
        auto views = load_camera_path(COPPICE_CONTENT_DIR "/paths/" + std::string(name) + "_views.json",
                                      scene.terrain.get());
        ASSERT_TRUE(views) << to_string(views.error());
        ASSERT_EQ(views->size(), 6u) << name;
        auto above = [&](size_t i) {
            dvec3 at = (*views)[i].camera.position_world;
            return at.y - double(scene.terrain->height_at(float(at.x), float(at.z)));
        };
        EXPECT_LT(above(0), 3.0) << name;
        EXPECT_GT(above(5), 150.0) << name;
    }
}

// The scenes for everyone, and those that stand in them.
TEST(Content, EverySceneCanBeReadAndItsSourcesExist) {
    const std::filesystem::path folder = COPPICE_CONTENT_DIR "/scenes";
    size_t scenes = 0, mosaics = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (!entry.path().string().ends_with(".eco.json")) continue;
        auto tree = read_mosaic_tree(entry.path().string());
        ASSERT_TRUE(tree) << to_string(tree.error());
        if (!tree->root().file.places.empty()) {
            ++mosaics;
            continue;
        }
        ++scenes;
        if (entry.path().parent_path() != folder) continue;  // read with those they stand in
        for (const SceneModel& model : load_content(entry.path().stem().stem().string()).models)
            EXPECT_TRUE(std::filesystem::exists(model.source_path)) << model.source_path;
    }
    EXPECT_GE(scenes, 12u);
    EXPECT_GE(mosaics, 3u);
}

}  // namespace
}  // namespace coppice
