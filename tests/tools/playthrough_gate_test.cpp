// `coppice play` as a build machine's gate: budgets, goldens, repeats, by exit code and by what is left behind.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tests/tools/run_program.h"

namespace {

using nlohmann::json;

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Twenty-five daisies seen from near, of a height.
std::string write_scene(const std::string& folder, double height_m) {
    const std::string daisy = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    const json scene{{"name", "gate"},
                     {"plants", {{"daisy", {{"source", daisy}, {"height_m", 0.2}}}}},
                     {"terrain", {{"flat", {{"size_m", 32}, {"cell_m", 4}}}}},
                     {"placements",
                      {{{"scatter",
                         {{"plant", "daisy"},
                          {"grid", {{"spacing_m", 0.4}, {"jitter_m", 0.1}, {"columns", 5}, {"rows", 5}}},
                          {"height_m", {height_m, height_m}},
                          {"seed", 1}}}}}},
                     {"camera_path",
                      {{{"time_s", 0}, {"at", {0, 0.6, 1.6}}, {"pitch_deg", -15}},
                       {{"time_s", 1}, {"at", {0.4, 0.6, 1.6}}, {"pitch_deg", -15}}}}};
    const std::string path = folder + "/gate_" + std::to_string(int(height_m * 100)) + ".eco.json";
    std::ofstream(path) << scene.dump(2);
    return path;
}

ProgramResult play(const std::string& folder, const std::string& scene, std::vector<std::string> more,
                   const char* size = "96x64") {
    std::vector<std::string> words{"play",     scene, "--headless", size,
                                   "--fps",    "4",   "--cache",    folder + "/cache",
                                   "--warmup", "1",   "--pictures", "0,4"};
    words.insert(words.end(), more.begin(), more.end());
    return run_coppice(words);
}

json check_called(const json& summary, const std::string& name) {
    for (const json& check : summary.at("checks"))
        if (check.at("name") == name) return check;
    ADD_FAILURE() << "no check " << name;
    return {};
}

}  // namespace

TEST(Gate, BudgetsDecideTheExitCode) {
    const std::string folder = fresh_folder(), scene = write_scene(folder, 0.3), out = folder + "/out";
    const ProgramResult kept =
        play(folder, scene,
             {"--repeats", "2", "--out", out, "--budget", "memory=4GiB,vertices=10000000,error=0.9"});
    ASSERT_EQ(kept.exit_code, 0) << kept.err;
    const json summary = json::parse(read_file(out + "/summary.json"));
    EXPECT_EQ(check_called(summary, "memory").at("verdict"), "passed");
    EXPECT_GT(check_called(summary, "memory").at("value"), 1.0);
    EXPECT_GT(check_called(summary, "error").at("value"), 0.0)
        << "compared with every triangle without being told to";
    EXPECT_EQ(check_called(summary, "repeats draw the same").at("verdict"), "passed");
    EXPECT_EQ(summary.at("settings").at("repeats"), 2);

    const ProgramResult over = play(folder, scene, {"--out", out, "--budget", "points=10,memory=4GiB"});
    EXPECT_EQ(over.exit_code, 1) << over.err;
    EXPECT_NE(over.err.find("points"), std::string::npos) << over.err;
    EXPECT_NE(read_file(out + "/junit.xml").find("tests=\"2\" failures=\"1\""), std::string::npos);
    EXPECT_NE(read_file(out + "/index.html").find("against a budget of 10"), std::string::npos);
    EXPECT_EQ(json::parse(read_file(out + "/trace.json")).at("displayTimeUnit"), "ms");

    EXPECT_EQ(play(folder, scene, {"--budget", "points=10ms"}).exit_code, 2);
}

TEST(Gate, GoldensAreMadeComparedAndShowWhatDiffers) {
    const std::string folder = fresh_folder(), scene = write_scene(folder, 0.3),
                      goldens = folder + "/goldens", out = folder + "/out";
    const ProgramResult missing = play(folder, scene, {"--golden", goldens});
    EXPECT_EQ(missing.exit_code, 1) << "a gate without goldens is no gate";
    EXPECT_NE(missing.err.find("--golden-update"), std::string::npos) << missing.err;

    ASSERT_EQ(play(folder, scene, {"--golden", goldens, "--golden-update"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(goldens + "/frame_0004.png"));
    const ProgramResult same =
        play(folder, scene, {"--golden", goldens, "--golden-tolerance", "0", "--out", out});
    EXPECT_EQ(same.exit_code, 0) << same.err;
    EXPECT_EQ(
        check_called(json::parse(read_file(out + "/summary.json")), "picture frame_0004.png").at("value"),
        0.0);

    const ProgramResult other = play(folder, write_scene(folder, 0.5), {"--golden", goldens, "--out", out});
    EXPECT_EQ(other.exit_code, 1) << "taller daisies";
    EXPECT_TRUE(read_file(out + "/frame_0004_difference.png").starts_with("\x89PNG"));
    const ProgramResult larger = play(folder, scene, {"--golden", goldens}, "100x64");
    EXPECT_EQ(larger.exit_code, 1) << larger.err;
    EXPECT_NE(larger.err.find("96 x 64"), std::string::npos) << larger.err;
    std::ofstream(goldens + "/frame_0000.png") << "no picture";
    EXPECT_EQ(play(folder, scene, {"--golden", goldens}).exit_code, 2);
}

TEST(Gate, ARecordedPathNeedsAWindow) {
    const std::string folder = fresh_folder();
    const ProgramResult result = play(folder, write_scene(folder, 0.3), {"--record", folder + "/path.json"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("--record"), std::string::npos) << result.err;
}
