// What `coppice inspect` says of a population.
#include <filesystem>
#include <string>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tests/tools/run_program.h"

namespace {

const std::string k_species = COPPICE_SOURCE_DIR "/content/species/grass.json";

ProgramResult inspect(const std::vector<std::string>& more, const std::string& cache) {
    std::vector<std::string> arguments{"inspect", k_species};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_coppice(arguments, {"XDG_CACHE_HOME=" + cache});
}

}  // namespace

TEST(Inspect, ShowsWhatFewerModelsLose) {
    const std::string cache = fresh_folder();
    const ProgramResult result = inspect({"--individuals", "11", "--json"}, cache);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << result.out;
    EXPECT_EQ(json["individuals"], 11);
    EXPECT_GT(json["height_most_m"], json["height_least_m"]);
    const auto& rows = json["quantised"];
    ASSERT_EQ(rows.size(), 5u);  // 1, 2, 4, 8 and 11 models
    for (size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(rows[i]["models"], i < 4 ? 1 << i : 11);
        EXPECT_EQ(rows[i]["individuals"].size(), rows[i]["models"]);
        if (i > 0) {
            EXPECT_LT(rows[i]["error"], rows[i - 1]["error"]);
        }
    }
    EXPECT_EQ(rows[4]["error"], 0.0);
    EXPECT_EQ(rows[4]["scale_least"], 1.0);
    EXPECT_EQ(rows[4]["scale_most"], 1.0);
}

TEST(Inspect, GrowsAPopulationOnce) {
    const std::string cache = fresh_folder();
    const ProgramResult first = inspect({"--individuals", "3"}, cache);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    EXPECT_NE(first.out.find("3 individuals"), std::string::npos) << first.out;
    EXPECT_TRUE(std::filesystem::is_directory(cache + "/coppice/populations"));
    EXPECT_EQ(inspect({"--individuals", "3"}, cache).out, first.out);
}

TEST(Inspect, ASpeciesNeedsItsNumberOfIndividualsAndAPlantHasNone) {
    const std::string cache = fresh_folder();
    for (const ProgramResult& result : {inspect({}, cache), inspect({"--individuals", "0"}, cache),
                                        inspect({"--individuals", "1025"}, cache),
                                        run_coppice({"inspect", "some.plant", "--individuals", "3"})}) {
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_NE(result.err.find("--individuals"), std::string::npos) << result.err;
    }
}
