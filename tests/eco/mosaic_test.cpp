// Mosaics as authors write them: which places scenes come to stand in, and which mosaics are refused.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/mosaic_tree.h"
#include "runtime/core/file.h"
#include "tests/eco/made_tiles.h"

namespace coppice {
namespace {

constexpr const char* k_scene = R"({"plants": {}, "placements": []})";

class Mosaics : public testing::Test {
  protected:
    Mosaics() : folder_("mosaics_") { write("wood", k_scene); }
    std::string path_of(const std::string& name) const { return folder_.path_of(name + ".eco.json"); }
    void write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories(std::filesystem::path(path_of(name)).parent_path());
        ASSERT_TRUE(write_text_file(path_of(name), text));
    }
    void write_mosaic(const std::string& name, const std::string& below, const std::string& more = "") {
        write(name, fmt::format(R"({{"mosaic": [{{"scene": "{}.eco.json"{}}}]}})", below, more));
    }
    MosaicTree read(const std::string& name) const {
        auto tree = read_mosaic_tree(path_of(name));
        EXPECT_TRUE(tree) << (tree ? "" : to_string(tree.error()));
        return tree ? std::move(*tree) : MosaicTree{};
    }
    Error error_of(const std::string& name) const {
        const auto tree = read_mosaic_tree(path_of(name));
        EXPECT_FALSE(tree) << "accepted";
        return tree ? Error{} : tree.error();
    }
    Error error_of_text(const std::string& text) {
        write("text", text);
        return error_of("text");
    }
    ScratchFolder folder_;
};

TEST_F(Mosaics, ASceneIsNone) {
    const MosaicTree tree = read("wood");
    ASSERT_EQ(tree.nodes.size(), 1u);
    EXPECT_TRUE(tree.root().file.places.empty());
    EXPECT_EQ(tree.root().folder, "");
    EXPECT_EQ(tree.root().scene_count, 1u);
}

TEST_F(Mosaics, CopiesStandAboutTheirPlaceByRows) {
    write_mosaic("mosaic", "wood",
                 R"(, "at": [10, -3.0625], "grid": {"columns": 3, "rows": 2, "spacing_m": 8})");
    const MosaicTree tree = read("mosaic");
    ASSERT_EQ(tree.nodes.size(), 2u);
    EXPECT_EQ(tree.root().scene_count, 6u);
    EXPECT_EQ(tree.root().file.name, "mosaic");
    ASSERT_EQ(tree.root().file.places.size(), 1u);
    const PlacedScene& placed = tree.root().file.places[0];
    std::vector<dvec3> origins;
    for (uint64_t copy = 0; copy < placed.copy_count(); ++copy) origins.push_back(placed.origin_of(copy));
    EXPECT_EQ(origins, (std::vector<dvec3>{{2, 0, -7.0625},
                                           {10, 0, -7.0625},
                                           {18, 0, -7.0625},
                                           {2, 0, 0.9375},
                                           {10, 0, 0.9375},
                                           {18, 0, 0.9375}}));
    EXPECT_GE(tree.root().reach_m, std::sqrt(18.0 * 18.0 + 7.0625 * 7.0625)) << "the farthest corner";
    EXPECT_LE(tree.root().reach_m, 20.0);
    ASSERT_EQ(tree.root().file.camera_path.size(), 1u) << "one of its own where none is written";
}

TEST_F(Mosaics, EveryFileIsReadOnceByWhateverName) {
    write("parts/grove", k_scene);
    write("parts/inner",
          R"({"mosaic": [{"scene": "grove.eco.json"}, {"scene": "../wood.eco.json", "at": [9, 9]}]})");
    write(
        "outer",
        R"({"mosaic": [{"scene": "parts/inner.eco.json", "grid": {"columns": 8, "rows": 4, "spacing_m": 64}},
        {"scene": "parts/../wood.eco.json"}, {"scene": "./parts/grove.eco.json", "at": [1, 1]}]})");
    const MosaicTree tree = read("outer");
    ASSERT_EQ(tree.nodes.size(), 4u);
    EXPECT_EQ(tree.root().scene_count, 32u * 2 + 2);
    std::vector<std::string> folders;
    for (size_t n = 0; n < tree.nodes.size(); ++n) {
        for (uint32_t below : tree.nodes[n].scenes) EXPECT_LT(below, n) << "those below come first";
        folders.push_back(tree.nodes[n].folder);
    }
    EXPECT_EQ(tree.root().folder, "");
    std::sort(folders.begin(), folders.end());
    EXPECT_EQ(std::unique(folders.begin(), folders.end()), folders.end());
    EXPECT_TRUE(folders[1].starts_with("grove-")) << folders[1];
    // Two scenes of one name are told apart, wherever all of it lies.
    write("parts/wood", k_scene);
    write("two", R"({"mosaic": [{"scene": "wood.eco.json"}, {"scene": "parts/wood.eco.json"}]})");
    const MosaicTree two = read("two");
    EXPECT_NE(two.nodes[0].folder, two.nodes[1].folder);
    ScratchFolder elsewhere("mosaics_elsewhere_");
    std::filesystem::copy(folder_.path_of(""), elsewhere.path_of("below"),
                          std::filesystem::copy_options::recursive);
    const auto moved = read_mosaic_tree(elsewhere.path_of("below/two.eco.json"));
    ASSERT_TRUE(moved);
    for (size_t n = 0; n < 2; ++n) EXPECT_EQ(moved->nodes[n].folder, two.nodes[n].folder);
}

TEST_F(Mosaics, AreReadStrictly) {
    using nlohmann::json;
    const json sound = json::parse(R"({"name": "m", "mosaic": [{"scene": "wood.eco.json", "at": [0.0625, 16],
        "grid": {"columns": 2, "rows": 2, "spacing_m": 128}}], "sun": null, "exposure": 1,
        "camera_path": [{"time_s": 0, "at": [0, 0], "above_m": 2}], "sample_distance_px": 2})");
    write("text", sound.dump());
    EXPECT_EQ(read("text").root().file.sample_distance_px, 2.0f);
    auto after = [&](const std::function<void(json&)>& change) {
        json changed = sound;
        change(changed);
        const Error error = error_of_text(changed.dump());
        EXPECT_EQ(error.file, path_of("text"));
        EXPECT_FALSE(error.fault.empty());
        EXPECT_FALSE(error.remedy.empty());
        return error;
    };
    EXPECT_EQ(after([](json& j) { j["mosaic"] = json::array(); }).place, "mosaic");
    EXPECT_EQ(after([](json& j) { j["mosaic"] = "wood.eco.json"; }).place, "mosaic");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0].erase("scene"); }).place, "mosaic[0].scene");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["scene"] = "no.eco.json"; }).id, ErrorId::file_missing);
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["scene"] = "no.eco.json"; }).place, "mosaic[0].scene");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["at"][0] = 0.03; }).place, "mosaic[0].grid");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["at"] = {0, 0, 0}; }).place, "mosaic[0].at");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["at"][0] = 1e10; }).place, "mosaic[0].at");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["at"][0] = "x"; }).place, "mosaic[0].at");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["grid"]["spacing_m"] = 0; }).place,
              "mosaic[0].grid.spacing_m");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["grid"]["spacing_m"] = 100.1; }).place, "mosaic[0].grid");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["grid"]["rows"] = uint64_t(1) << 32; }).place,
              "mosaic[0].grid.rows");
    EXPECT_EQ(after([](json& j) { j["mosaic"][0]["grid"]["rows"] = 33; }).id, ErrorId::limit_exceeded);
    EXPECT_EQ(after([](json& j) {
                  for (int i = 0; i < 61; ++i) j["mosaic"].push_back({{"scene", "wood.eco.json"}});
              }).place,
              "mosaic");
    for (const char* key : {"turn_deg", "scale", "content"})
        EXPECT_EQ(after([key](json& j) { j["mosaic"][0][key] = 1; }).id, ErrorId::name_unknown) << key;
    for (const char* key : {"plants", "placements", "references", "regions", "terrain"})
        EXPECT_EQ(after([key](json& j) { j[key] = json::object(); }).place, key);
    EXPECT_EQ(after([](json& j) { j["mosiac"] = 1; }).id, ErrorId::name_unknown);
    EXPECT_EQ(after([](json& j) { j["camera_path"][0]["above_m"] = "high"; }).place,
              "camera_path[0].above_m");
    EXPECT_EQ(error_of_text(R"({"mosaic": [{"scene": "wood.eco.json")").id, ErrorId::syntax);
    write("wood", "{");
    EXPECT_EQ(error_of_text(sound.dump()).file, path_of("wood"));
}

TEST_F(Mosaics, ThatStandInThemselvesAreRefused) {
    write_mosaic("a", "b");
    write("b", R"({"mosaic": [{"scene": "wood.eco.json"}, {"scene": "c.eco.json"}]})");
    write_mosaic("c",
                 "../" + std::filesystem::path(folder_.path_of("")).parent_path().filename().string() + "/a");
    const Error error = error_of("a");
    EXPECT_EQ(error.id, ErrorId::value_out_of_range);
    EXPECT_EQ(error.file, path_of("c"));
    EXPECT_EQ(error.place, "mosaic[0].scene");
    EXPECT_EQ(error.fault, "a scene in itself: " + path_of("a") + " -> " + path_of("b") + " -> " +
                               path_of("c") + " -> " + path_of("a"));
    write_mosaic("self", "self");
    EXPECT_EQ(error_of("self").id, ErrorId::value_out_of_range);
}

TEST_F(Mosaics, OfTooManyInsideEachOtherAreRefused) {
    std::string below = "wood";
    for (int depth = 1; depth <= 17; ++depth) {
        const std::string name = fmt::format("depth {}", depth);
        write_mosaic(name, below, R"(, "grid": {"columns": 8, "rows": 8, "spacing_m": 0.125})");
        below = name;
    }
    EXPECT_EQ(read("depth 10").root().scene_count, uint64_t(1) << 60);
    EXPECT_EQ(error_of("depth 11").id, ErrorId::limit_exceeded) << "2^66 scenes";
    below = "wood";
    for (int depth = 1; depth <= 17; ++depth) {
        const std::string name = fmt::format("single {}", depth);
        write_mosaic(name, below);
        below = name;
    }
    EXPECT_EQ(read("single 16").nodes.size(), 17u);
    const Error error = error_of("single 17");
    EXPECT_EQ(error.id, ErrorId::limit_exceeded);
    EXPECT_EQ(error.file, path_of("single 1"));
    write("known", R"({"mosaic": [{"scene": "single 15.eco.json"}, {"scene": "higher.eco.json"}]})");
    write_mosaic("higher", "single 15");
    EXPECT_EQ(error_of("known").file, path_of("higher")) << "read before, on a shorter way";
}

TEST_F(Mosaics, OutOfReachAreRefused) {
    write_mosaic("far", "wood", R"(, "at": [3e9, 0])");
    write_mosaic("farther", "far", R"(, "at": [0, 3e9])");
    read("far");
    EXPECT_EQ(error_of("farther").place, "mosaic[0]");
    write_mosaic("wide", "wood", R"(, "grid": {"columns": 64, "rows": 1, "spacing_m": 4e9})");
    EXPECT_EQ(error_of("wide").id, ErrorId::value_out_of_range);
}

TEST_F(Mosaics, AreNeitherLoadedNorReferredTo) {
    write_mosaic("mosaic", "wood");
    const auto loaded = load_scene(path_of("mosaic"), {});
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().place, "mosaic");
    EXPECT_NE(loaded.error().remedy.find("coppice populate"), std::string::npos);
    write("scene", R"({"references": [{"scene": "mosaic.eco.json"}]})");
    const auto referring = load_scene(path_of("scene"), {});
    ASSERT_FALSE(referring);
    EXPECT_EQ(referring.error().file, path_of("mosaic"));
}

TEST(MosaicSums, AreCheckedAt64Bits) {
    uint64_t sum = 5;
    EXPECT_TRUE(add_product(sum, 3, 4));
    EXPECT_EQ(sum, 17u);
    EXPECT_TRUE(add_product(sum, 0, UINT64_MAX));
    EXPECT_FALSE(add_product(sum, 1, UINT64_MAX - 16));
    EXPECT_FALSE(add_product(sum, uint64_t(1) << 32, uint64_t(1) << 32));
    EXPECT_EQ(sum, 17u);
    EXPECT_TRUE(add_product(sum, 1, UINT64_MAX - 17));
    EXPECT_EQ(sum, UINT64_MAX);
}

}  // namespace
}  // namespace coppice
