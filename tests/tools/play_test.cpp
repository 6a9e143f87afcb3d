// A whole playthrough of a small scene: what it leaves behind, and that it leaves the same behind every time.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/images/images.h"
#include "runtime/plugin/registry.h"
#include "tests/tools/run_program.h"

namespace {

using namespace coppice;
using nlohmann::json;

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Nine daisies on a flat meadow, seen from 3 m while moving 1 m to the side in one second.
json meadow() {
    const std::string daisy = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    return {{"name", "test meadow"},
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
}

std::string write_scene(const std::string& folder, const json& scene = meadow()) {
    const std::string path = folder + "/meadow.eco.json";
    std::ofstream(path) << scene.dump(2);
    return path;
}

// The first picture of a playthrough: frame 0.
Picture first_picture(const std::string& out) {
    Registry registry;
    EXPECT_TRUE(registry.load("images"));
    const auto* images = registry.find<ImagesInterface>(k_images_interface, k_images_version);
    return images ? images->read(out + "/frame_0000.png").value_or(Picture{}) : Picture{};
}

// Every pixel becomes the mean of its block of 8 x 8.
Picture mean_of_blocks(const Picture& picture) {
    Picture out = picture;
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x)
            for (uint32_t c = 0; c < 4; ++c) {
                uint32_t sum = 0, count = 0;
                for (uint32_t v = y / 8 * 8; v < std::min(y / 8 * 8 + 8, picture.height); ++v)
                    for (uint32_t u = x / 8 * 8; u < std::min(x / 8 * 8 + 8, picture.width); ++u, ++count)
                        sum += picture.rgba[4 * (size_t(v) * picture.width + u) + c];
                out.rgba[4 * (size_t(y) * picture.width + x) + c] = uint8_t(sum / count);
            }
    return out;
}

double psnr_db(const Picture& a, const Picture& b) {
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    EXPECT_FALSE(a.empty());
    double sum = 0.0;
    for (size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
        if (i % 4 != 3) sum += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2.0);
    return 10.0 * std::log10(255.0 * 255.0 / (sum / (0.75 * double(a.rgba.size()))));
}

std::vector<std::string> play(const std::string& scene, const std::string& out,
                              std::vector<std::string> more = {}) {
    std::vector<std::string> words{"play",     scene,   "--headless", "96x64",   "--out",
                                   out,        "--fps", "8",          "--cache", out + "_cache",
                                   "--warmup", "1",     "--pictures", "0,8"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

// Another value of an option that the words have.
std::vector<std::string> with(std::vector<std::string> words, const std::string& option,
                              const std::string& value) {
    auto found = std::find(words.begin(), words.end(), option);
    EXPECT_NE(found, words.end()) << option;
    *(found + 1) = value;
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
    EXPECT_TRUE(csv.starts_with("frame,repeat,time_s,CPUStartTime,FrameTime,CPUBusy,CPUWait,GPUBusy,"));

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

TEST(Play, DrawsAsManyVerticesAsItMay) {
    const std::string folder = fresh_folder(), scene = write_scene(folder);
    ASSERT_EQ(run_coppice(play(scene, folder + "/a")).exit_code, 0);
    const json free = json::parse(read_file(folder + "/a/summary.json"));
    const std::string half = std::to_string(uint64_t(figure(free, "vertices") / 2.0));
    ASSERT_EQ(run_coppice(play(scene, folder + "/b", {"--vertices", half})).exit_code, 0);
    const json held = json::parse(read_file(folder + "/b/summary.json"));
    EXPECT_GT(figure(held, "sample_distance_px"), figure(free, "sample_distance_px"));
    // Nine plants round to whole points.
    EXPECT_NEAR(figure(held, "vertices"), std::stod(half), 0.1 * std::stod(half));
    EXPECT_EQ(held.at("settings").at("vertex_budget"), std::stoull(half));
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
    json close = meadow();  // ferns that fill half the picture
    close["plants"]["daisy"]["source"] = std::string(COPPICE_SOURCE_DIR) + "/content/species/fern.json";
    for (json& key : close["camera_path"]) key["at"] = {0, 0.9, 1.6};
    const std::string scene = write_scene(folder, close);
    const ProgramResult result = run_coppice(play(scene, out, {"--compare-full", "--compare-frames", "2"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    ASSERT_EQ(run_coppice(play(scene, folder + "/full", {"--full"})).exit_code, 0);
    json bare = close;
    bare["placements"] = json::array();
    ASSERT_EQ(run_coppice(play(write_scene(folder, bare), folder + "/bare")).exit_code, 0);
    const Picture lod_picture = first_picture(out), full_picture = first_picture(folder + "/full");

    const json summary = json::parse(read_file(out + "/summary.json"));
    ASSERT_EQ(summary.at("compared").size(), 2u);
    for (const json& frame : summary["compared"]) {
        EXPECT_GT(frame.at("full_ms").get<double>(), 0);
        EXPECT_GT(frame.at("full_triangles").get<uint64_t>(), 0u);
    }
    EXPECT_NEAR(summary["compared"][0].at("psnr_db").get<double>(), psnr_db(lod_picture, full_picture), 0.01);
    // Sky and ground agree by themselves, and points are not where the triangles' pixels are: blocks of
    // pixels must agree far better than they do with a frame without plants.
    const double bare_db =
        psnr_db(mean_of_blocks(first_picture(folder + "/bare")), mean_of_blocks(full_picture));
    EXPECT_GT(psnr_db(mean_of_blocks(lod_picture), mean_of_blocks(full_picture)), bare_db + 6.0);
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
    EXPECT_FALSE(std::filesystem::exists(folder + "/out_cache")) << "plants were cooked for nothing";
}

TEST(Play, FliesAPlantWithoutAScene) {
    const std::string folder = fresh_folder(), packed = folder + "/daisy.plant";
    const std::string daisy = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    ASSERT_EQ(run_coppice({"cook", daisy, "-o", packed}).exit_code, 0);
    std::vector<json> pictures;
    for (const std::string& plant : {daisy, packed}) {
        const std::string out = folder + "/out" + plant.substr(plant.rfind('.'));
        const ProgramResult result =
            run_coppice(with(with(play(plant, out), "--fps", "1"), "--pictures", "0,12"));
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const json summary = json::parse(read_file(out + "/summary.json"));
        EXPECT_GT(figure(summary, "plants"), 100) << "a grove";
        EXPECT_GT(figure(summary, "points"), 0);
        ASSERT_EQ(summary.at("pictures").size(), 2u) << "near and far";
        pictures.push_back(summary["pictures"]);
    }
    EXPECT_EQ(pictures[0], pictures[1]) << "the species and what was packed of it";
}

TEST(Play, ABrokenOrUnwritableCacheIsNoReasonToFail) {
    const std::string folder = fresh_folder(), scene = write_scene(folder), out = folder + "/out";
    ASSERT_EQ(run_coppice(play(scene, out)).exit_code, 0);
    for (const auto& entry : std::filesystem::directory_iterator(out + "_cache/plants"))
        std::filesystem::resize_file(entry.path(), 100);
    const ProgramResult again = run_coppice(play(scene, out));
    EXPECT_EQ(again.exit_code, 0) << again.err;

    std::ofstream(folder + "/in the way") << "a file";
    const ProgramResult unwritable = run_coppice(with(play(scene, out), "--cache", folder + "/in the way"));
    EXPECT_EQ(unwritable.exit_code, 0) << unwritable.err;
    EXPECT_NE(unwritable.err.find("in the way"), std::string::npos) << unwritable.err;
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
