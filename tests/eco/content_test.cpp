// The scenes that come with the program can be read, and hold what they say.
#include <filesystem>
#include <set>
#include "plugins/vegetation/eco/load_scene.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

Scene load_content(const std::string& name) {
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    auto scene = load_scene(COPPICE_CONTENT_DIR "/scenes/" + name + ".eco.json", {&k_terrain});
    EXPECT_TRUE(scene) << (scene ? "" : to_string(scene.error()));
    return scene ? std::move(*scene) : Scene{};
}

TEST(Content, PinesAre640) {
    Scene scene = load_content("pines");
    EXPECT_EQ(scene.positions.size(), 640u);
    EXPECT_EQ(scene.models.size(), 5u);
}

TEST(Content, StandsHaveTheirTrees) {
    EXPECT_EQ(load_content("stand_640").positions.size(), 640u);
    EXPECT_EQ(load_content("stand_5000").positions.size(), 5000u);
    EXPECT_EQ(load_content("stand_50000").positions.size(), 50000u);
}

TEST(Content, WoodlandIsMixedAndTheFlightStaysAboveGround) {
    Scene scene = load_content("woodland");
    std::set<std::string> names;
    for (const PlantModel& plant : scene.plant_models) names.insert(scene.models[plant.model].name);
    for (const char* name : {"oak", "birch", "pine", "shrub", "grass", "daisy", "sunflower"})
        EXPECT_TRUE(names.count(name)) << name;
    EXPECT_GT(scene.positions.size(), 20000u);
    ASSERT_GE(scene.camera_path.back().time_s, 20.0);
    for (double time = 0.0; time <= scene.camera_path.back().time_s; time += 0.05) {
        dvec3 at = camera_at(scene.camera_path, time).position_world;
        ASSERT_GT(at.y, double(scene.terrain->height_at(float(at.x), float(at.z))) + 0.6) << time;
    }
}

TEST(Content, EverySourceExists) {
    for (const char* name : {"pines", "woodland", "stand_640", "stand_5000", "stand_50000"})
        for (const SceneModel& model : load_content(name).models)
            EXPECT_TRUE(std::filesystem::exists(model.source_path)) << model.source_path;
}

}  // namespace
}  // namespace coppice
