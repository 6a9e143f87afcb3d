#include "plugins/vegetation/eco/populated_scene.h"

#include <gtest/gtest.h>
#include <functional>
#include <nlohmann/json.hpp>
#include "plugins/terrain/load_terrain.h"
#include "runtime/core/file.h"
#include "tests/eco/made_tiles.h"

namespace coppice {
namespace {

constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};

class PopulatedScenes : public testing::Test {
  protected:
    PopulatedScenes() : folder_("populated_scene_"), made_(make_tile_tree(3, 0, 20, 10)) {
        const TilePack pack = write_and_open(made_, folder_.path_of("tiles.tiles"));
        populated_.scene.name = "a \"scene\"";
        populated_.scene.models = made_.scene.models;
        populated_.model_content_hashes = {100, 101};
        populated_.packs = {
            {"tiles.tiles", pack.content_hash, pack.nodes[0].plant_count, uint64_t(1234567890123)}};
        populated_.terrain_json = R"({"flat":{"size_m":100,"height_m":0.1}})";
        Camera camera;
        camera.position_world = dvec3(1e7 + 1.0 / 3.0, 0.1, -2.0);
        camera.yaw_rad = 0.1f;
        populated_.scene.camera_path = {{0.0, camera}, {1.0 / 3.0, Camera{}}};
        populated_.scene.light.haze_density_per_m = 0.1f;
        populated_.scene.sample_distance_px = 0.7f;
    }
    std::string path() const { return folder_.path_of("scene.json"); }
    Result<PopulatedScene> load(const std::string& text) {
        EXPECT_TRUE(write_text_file(path(), text));
        return load_populated_scene(path(), &k_terrain);
    }
    Error error_after(const std::function<void(nlohmann::json&)>& change) {
        nlohmann::json root = nlohmann::json::parse(write_populated_scene(populated_));
        change(root);
        const auto loaded = load(root.dump());
        EXPECT_FALSE(loaded) << "accepted";
        return loaded ? Error{} : loaded.error();
    }
    ScratchFolder folder_;
    MadeTiles made_;
    PopulatedScene populated_;
};

TEST_F(PopulatedScenes, GiveBackWhatWasWrittenToTheLastBit) {
    populated_.scene.models[1].color_variation = {0.1f, 7.0f, 1.0f / 3.0f};
    const std::string text = write_populated_scene(populated_);
    auto loaded = load(text);
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    EXPECT_EQ(loaded->scene.name, populated_.scene.name);
    ASSERT_EQ(loaded->scene.models.size(), 2u);
    EXPECT_EQ(loaded->scene.models[0].source_path, folder_.path_of("plants/oak.plant"));
    EXPECT_EQ(loaded->scene.models[1].importance, 1.5f);
    EXPECT_EQ(loaded->scene.models[0].color_variation, ColorVariation{});
    EXPECT_EQ(loaded->scene.models[1].color_variation, populated_.scene.models[1].color_variation);
    EXPECT_EQ(loaded->model_content_hashes, populated_.model_content_hashes);
    EXPECT_EQ(loaded->packs[0].triangle_count, 1234567890123u);
    EXPECT_EQ(loaded->scene.light, populated_.scene.light);
    ASSERT_EQ(loaded->scene.camera_path.size(), 2u);
    EXPECT_EQ(loaded->scene.camera_path[0].camera, populated_.scene.camera_path[0].camera);
    EXPECT_EQ(loaded->scene.camera_path[1].time_s, 1.0 / 3.0);
    EXPECT_EQ(loaded->scene.sample_distance_px, 0.7f);
    ASSERT_TRUE(loaded->scene.terrain);
    EXPECT_EQ(loaded->scene.terrain->height_at(3.0f, 4.0f), 0.1f);
    EXPECT_TRUE(loaded->scene.tiles.empty());
    loaded->scene.models = populated_.scene.models;
    loaded->packs[0].path = "tiles.tiles";
    EXPECT_EQ(write_populated_scene(*loaded), text);
}

TEST_F(PopulatedScenes, OpenTheirOwnPacksAndNoOthers) {
    auto loaded = load(write_populated_scene(populated_));
    ASSERT_TRUE(loaded);
    auto packs = open_packs(*loaded);
    ASSERT_TRUE(packs) << to_string(packs.error());
    EXPECT_EQ(packs->size(), 1u);

    std::vector<Plant> others = made_.plants;
    others[1].content_hash ^= 1;
    EXPECT_TRUE(check_plants(*loaded, made_.plants));
    EXPECT_EQ(check_plants(*loaded, others).error().file, loaded->scene.models[1].source_path);
    PopulatedScene other_models = *loaded;
    other_models.model_content_hashes[1] ^= 1;
    EXPECT_EQ(open_packs(other_models).error().place, "models");
    write_and_open(make_tile_tree(3, 0, 20, 10, 9), folder_.path_of("tiles.tiles"));
    EXPECT_EQ(open_packs(*loaded).error().id, ErrorId::file_corrupt) << "another scene's";
    std::filesystem::remove(folder_.path_of("tiles.tiles"));
    EXPECT_EQ(open_packs(*loaded).error().id, ErrorId::file_missing);
}

TEST_F(PopulatedScenes, AreReadStrictly) {
    using nlohmann::json;
    EXPECT_EQ(load("{}").error().id, ErrorId::format_unknown);
    EXPECT_EQ(load("{\"populated\": 3").error().id, ErrorId::syntax);
    const Error older = error_after([](json& j) { j["populated"] = 1; });
    EXPECT_EQ(older.id, ErrorId::format_unknown);
    EXPECT_EQ(older.place, "populated");
    EXPECT_NE(older.remedy.find("populate the scene again"), std::string::npos) << older.remedy;
    EXPECT_EQ(error_after([](json& j) { j["populated"] = "2"; }).place, "populated");
    EXPECT_EQ(error_after([](json& j) { j["lihgt"] = 2; }).id, ErrorId::name_unknown);
    EXPECT_EQ(error_after([](json& j) { j.erase("light"); }).place, "light");
    EXPECT_EQ(error_after([](json& j) { j["packs"][0]["content"] = "12"; }).place, "packs[0].content");
    EXPECT_EQ(error_after([](json& j) { j["packs"][0]["content"] = "000000000000000g"; }).place,
              "packs[0].content");
    EXPECT_EQ(error_after([](json& j) { j["packs"][0]["plants"] = -1; }).place, "packs[0].plants");
    EXPECT_EQ(error_after([](json& j) { j["plants"][1]["importance"] = 0; }).place, "plants[1].importance");
    EXPECT_EQ(error_after([](json& j) { j["camera_path"] = json::array(); }).place, "camera_path");
    EXPECT_EQ(error_after([](json& j) { j["camera_path"][1]["time_s"] = 0; }).place, "camera_path[1].time_s");
    EXPECT_EQ(error_after([](json& j) { j["camera_path"][0]["at"][1] = 1e300; }).place, "camera_path[0].at");
    EXPECT_EQ(error_after([](json& j) {
                  j["terrain"] = {{"flat", {{"size_m", -1}}}};
              }).id,
              ErrorId::value_out_of_range);
    auto without = load_populated_scene(path(), nullptr);
    ASSERT_FALSE(without);
    EXPECT_EQ(without.error().id, ErrorId::name_unknown);
}

}  // namespace
}  // namespace coppice
