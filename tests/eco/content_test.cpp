// The scenes that come with the program can be read, and hold what they say.
#include <algorithm>
#include <filesystem>
#include <set>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/load_scene.h"
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
    for (const char* name : {"woodland", "palms", "sunflowers", "landscape"}) {
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

TEST(Content, EverySourceExists) {
    for (const char* name : {"pines", "woodland", "palms", "sunflowers", "landscape", "stand_640",
                             "stand_5000", "stand_50000", "thicket_100000"})
        for (const SceneModel& model : load_content(name).models)
            EXPECT_TRUE(std::filesystem::exists(model.source_path)) << model.source_path;
}

}  // namespace
}  // namespace coppice
