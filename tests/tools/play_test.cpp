// A whole playthrough of a small scene: what it leaves behind, and that it leaves the same behind every time.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tests/tools/run_program.h"

namespace {

using nlohmann::json;

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Nine daisies on a flat meadow, seen from 3 m while moving 1 m to the side in one second.
std::string write_scene(const std::string& folder) {
    const std::string daisy = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    const json scene{{"name", "test meadow"},
                     {"plants", {{"daisy", {{"source", daisy}, {"height_m", 0.2}}}}},
                     {"terrain", {{"flat", {{"size_m", 32}, {"cell_m", 4}}}}},
                     {"placements",
                      {{{"scatter",
                         {{"plant", "daisy"},
                          {"grid", {{"spacing_m", 0.5}, {"jitter_m", 0.1}, {"columns", 3}, {"rows", 3}}},
                          {"seed", 1}}}}}},
                     {"camera_path",
                      {{{"time_s", 0}, {"at", {0, 0.8, 3}}, {"pitch_deg", -12}, {"fov_deg", 60}},
                       {{"time_s", 1}, {"at", {1, 0.8, 3}}, {"pitch_deg", -12}, {"fov_deg", 60}}}}};
    const std::string path = folder + "/meadow.eco.json";
    std::ofstream(path) << scene.dump(2);
    return path;
}

std::vector<std::string> play(const std::string& scene, const std::string& out,
                              std::vector<std::string> more = {}) {
    std::vector<std::string> words{"play",     scene,   "--headless", "96x64",   "--out",
                                   out,        "--fps", "8",          "--cache", out + "_cache",
                                   "--warmup", "1",     "--pictures", "0,8"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

double figure(const json& summary, const std::string& name) {
    for (const json& one : summary.at("figures"))
        if (one.at("name") == name) return one.at("value").get<double>();
    ADD_FAILURE() << "no figure " << name;
    return 0.0;
}

}  // namespace

TEST(Play, LeavesPicturesTablesAndAPage) {
    const std::string folder = fresh_folder(), out = folder + "/out";
    const ProgramResult result = run_coppice(play(write_scene(folder), out));
    ASSERT_EQ(result.exit_code, 0) << result.err;

    const std::string csv = read_file(out + "/frames.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 9)
        << "a head and the frames 0 to 8 of one second at 8 Hz";
    EXPECT_TRUE(csv.starts_with("frame,time_s,wall_ms,"));

    const json summary = json::parse(read_file(out + "/summary.json"));
    EXPECT_EQ(figure(summary, "plants"), 9);
    EXPECT_GT(figure(summary, "median_ms"), 0);
    EXPECT_GT(figure(summary, "vertices"), 0);
    EXPECT_EQ(figure(summary, "dropped_entries"), 0);
    EXPECT_NEAR(figure(summary, "median_hz") * figure(summary, "median_ms"), 1000.0, 0.01);
    for (const json& one : summary.at("figures"))
        for (const char* key : {"name", "value", "unit", "reach", "holds"})
            EXPECT_TRUE(one.contains(key)) << one;

    ASSERT_EQ(summary.at("pictures").size(), 2u);
    EXPECT_NE(summary["pictures"][0]["hash"], summary["pictures"][1]["hash"]) << "the camera moves";
    for (const json& picture : summary["pictures"])
        EXPECT_TRUE(read_file(out + "/" + picture["file"].get<std::string>()).starts_with("\x89PNG\r\n"));

    const std::string page = read_file(out + "/index.html");
    EXPECT_NE(page.find("test meadow"), std::string::npos);
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos) << "the page needs nothing from elsewhere";
}

TEST(Play, DrawsTheSamePicturesEveryTime) {
    const std::string folder = fresh_folder(), scene = write_scene(folder);
    ASSERT_EQ(run_coppice(play(scene, folder + "/a")).exit_code, 0);
    ASSERT_EQ(run_coppice(play(scene, folder + "/b")).exit_code, 0);
    const json a = json::parse(read_file(folder + "/a/summary.json")),
               b = json::parse(read_file(folder + "/b/summary.json"));
    EXPECT_EQ(a.at("pictures"), b.at("pictures"));
    EXPECT_EQ(a.at("hashes"), b.at("hashes"));
}

TEST(Play, ComparesWithEveryTriangleInTheSameRun) {
    const std::string folder = fresh_folder(), out = folder + "/out";
    const ProgramResult result =
        run_coppice(play(write_scene(folder), out, {"--compare-full", "--compare-frames", "2"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json summary = json::parse(read_file(out + "/summary.json"));
    ASSERT_EQ(summary.at("compared").size(), 2u);
    for (const json& frame : summary["compared"]) {
        EXPECT_GT(frame.at("full_ms").get<double>(), 0);
        EXPECT_GT(frame.at("full_triangles").get<uint64_t>(), 0u);
        EXPECT_GT(frame.at("psnr_db").get<double>(), 15) << "the same meadow";
    }
}

TEST(Play, EveryTriangleIsDrawnWhenAsked) {
    const std::string folder = fresh_folder(), scene = write_scene(folder);
    ASSERT_EQ(run_coppice(play(scene, folder + "/lod", {"--sample-distance", "4"})).exit_code, 0);
    ASSERT_EQ(run_coppice(play(scene, folder + "/full", {"--full"})).exit_code, 0);
    const json lod = json::parse(read_file(folder + "/lod/summary.json"));
    const json full = json::parse(read_file(folder + "/full/summary.json"));
    EXPECT_EQ(figure(full, "triangles"), figure(full, "full_triangles_in_view"));
    EXPECT_EQ(figure(full, "points"), 0);
    EXPECT_LT(figure(lod, "vertices"), figure(full, "vertices"));
}

TEST(Play, WithoutADeviceTheExitCodeSaysSo) {
    const std::string folder = fresh_folder();
    const ProgramResult result =
        run_coppice(play(write_scene(folder), folder + "/out"),
                    {"VK_ICD_FILENAMES=/nonexistent", "VK_DRIVER_FILES=/nonexistent"});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder + "/out/index.html"));
}

TEST(Play, ADeviceOfAnotherNameIsBadInput) {
    const std::string folder = fresh_folder();
    const ProgramResult result =
        run_coppice(play(write_scene(folder), folder + "/out", {"--device", "no such device"}));
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find("no such device"), std::string::npos) << result.err;
}

TEST(Play, TheValidationLayersAreSilent) {
    const std::string folder = fresh_folder(), out = folder + "/out";
    const ProgramResult result = run_coppice(play(write_scene(folder), out, {"--validation"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(figure(json::parse(read_file(out + "/summary.json")), "validation_messages"), 0);
}
