// `coppice bench foliage`: what a run leaves behind, and what a plant without leaves is told.
#include <filesystem>
#include <fstream>
#include <string>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tests/tools/run_program.h"

namespace {

using nlohmann::json;
namespace files = std::filesystem;

const std::string k_content = std::string(COPPICE_SOURCE_DIR) + "/content";

ProgramResult bench(const std::string& folder, const std::string& plant) {
    return run_coppice({"bench", "foliage", "--scene", plant, "--content", k_content, "--cache",
                        folder + "/cache", "--out", folder + "/out", "--json", folder + "/foliage.json",
                        "--size", "64x48"});
}

TEST(BenchFoliage, LeavesAPageFourPicturesAndFigures) {
    const std::string folder = fresh_folder();
    const ProgramResult result = bench(folder, k_content + "/species/pine.json");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::ifstream stream(folder + "/foliage.json");
    const json made = json::parse(stream);
    EXPECT_EQ(made.at("name"), "foliage");
    const json& plant = made.at("plants").at(0);
    const uint32_t leaves = plant.at("leaves");
    EXPECT_EQ(plant.at("sweep").back().at("leaves"), leaves / 20) << "down to a twentieth";
    ASSERT_EQ(plant.at("drawn").size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(plant["drawn"][i]["leaves"], leaves * (4 - i) / 4);
        const std::string picture = plant["drawn"][i]["picture"];
        EXPECT_GT(files::file_size(folder + "/out/" + picture), 100u);
    }
    EXPECT_GT(files::file_size(folder + "/out/" + plant.at("grove").get<std::string>()), 100u);
    EXPECT_GT(files::file_size(folder + "/out/index.html"), 1000u);
    const json& figures = made.at("figures");
    auto value_of = [&](const std::string& name) {
        for (const json& figure : figures)
            if (figure.at("name") == "pine: " + name) return figure.at("value").get<double>();
        ADD_FAILURE() << name;
        return 0.0;
    };
    EXPECT_EQ(value_of("leaves"), leaves);
    // All bytes of the sweep, whatever time it took.
    double vdf_bytes = 0.0;
    for (const json& step : plant["sweep"]) vdf_bytes += step["vdf"]["bytes"].get<double>();
    EXPECT_NEAR(value_of("ours / VDF bytes"), 100.0 * 4.0 * double(plant["sweep"].size()) / vdf_bytes, 1e-9);
    EXPECT_LT(value_of("LoDF / VDF bytes"), 100.0);
}

TEST(BenchFoliage, APlantWithoutLeavesIsAnError) {
    const std::string folder = fresh_folder();
    const std::string stick = folder + "/stick.json";
    std::ofstream(stick) << R"({"name": "Stick", "form": "tree", "height_m": 2, "leaf_levels": 1,
        "levels": [{"sides": 3}], "leaves": {"count": 0}})";
    const ProgramResult result = bench(folder, stick);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find("leaves"), std::string::npos) << result.err;
}

}  // namespace
