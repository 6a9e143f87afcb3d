// `coppice bench accuracy`: what a user meets who mistypes, what a run leaves behind, and that references are traced once.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/images/images.h"
#include "runtime/plugin/registry.h"
#include "tests/tools/run_program.h"

namespace {

using namespace coppice;
using nlohmann::json;
namespace files = std::filesystem;

std::string read_file(const files::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const files::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

// Four daisies on a flat meadow, seen from one place.
json meadow() {
    const std::string daisy = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    return {{"name", "test meadow"},
            {"plants", {{"daisy", {{"source", daisy}, {"height_m", 0.2}}}}},
            {"terrain", {{"flat", {{"size_m", 16}, {"cell_m", 4}}}}},
            {"placements",
             {{{"scatter",
                {{"plant", "daisy"},
                 {"grid", {{"spacing_m", 0.4}, {"jitter_m", 0.1}, {"columns", 2}, {"rows", 2}}},
                 {"seed", 1}}}}}},
            {"camera_path", {{{"time_s", 0}, {"at", {0, 0.5, 1.2}}, {"pitch_deg", -15}, {"fov_deg", 60}}}}};
}

std::string write_scene(const std::string& folder, const json& scene = meadow()) {
    const std::string path = folder + "/meadow.eco.json";
    write_file(path, scene.dump(2));
    return path;
}

ProgramResult bench(const std::string& folder, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"bench",   "accuracy",        "--scene", folder + "/meadow.eco.json",
                                   "--cache", folder + "/cache", "--out",   folder + "/out"};
    words.insert(words.end(), more.begin(), more.end());
    return run_coppice(words);
}

// One line on standard error, from us, that has all words in it.
void expect_failure(const ProgramResult& result, int exit_code, const std::vector<std::string>& words) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    const size_t line = result.err.rfind("coppice: ");
    ASSERT_NE(line, std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin() + std::ptrdiff_t(line), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& word : words)
        EXPECT_NE(result.err.find(word, line), std::string::npos) << word << " in: " << result.err;
}

TEST(BenchAccuracy, AnUnknownMethodNamesTheKnownOnes) {
    const std::string folder = fresh_folder();
    write_scene(folder);
    for (const char* methods : {"hybird", "measured;hybird", ";measured"})
        expect_failure(bench(folder, {"--methods", methods, "--size", "64x48"}), 2,
                       {"full, 1 sample", "hybrid, measured", "billboards", "--methods"});
    EXPECT_FALSE(files::exists(folder + "/cache/references"));
}

TEST(BenchAccuracy, APictureSizeThatCannotBeMeantIsAUsageError) {
    const std::string folder = fresh_folder();
    write_scene(folder);
    for (const char* size : {"0x0", "64", "64x", "-64x48", "64x99999"})
        expect_failure(bench(folder, {"--size", size}), 2, {"--size", size, "1280x720"});
}

TEST(BenchAccuracy, ASceneWithoutPlantsHasNothingToMeasure) {
    const std::string folder = fresh_folder();
    json bare = meadow();
    bare["placements"] = json::array();
    write_scene(folder, bare);
    expect_failure(bench(folder, {"--size", "64x48"}), 2, {"meadow.eco.json", "without plants"});
    EXPECT_FALSE(files::exists(folder + "/out/index.html"));
}

TEST(BenchAccuracy, AMissingSceneOrPathOfViewsIsBadInput) {
    const std::string folder = fresh_folder();
    expect_failure(bench(folder, {"--size", "64x48"}), 2, {"meadow.eco.json"});
    write_scene(folder);
    expect_failure(bench(folder, {"--size", "64x48", "--views", folder + "/none.json"}), 2, {"none.json"});
}

std::map<std::string, std::string> files_of(const std::string& folder) {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : files::directory_iterator(folder))
        bytes[entry.path().filename().string()] = read_file(entry.path());
    return bytes;
}

std::map<std::string, files::file_time_type> times_of(const std::string& folder) {
    std::map<std::string, files::file_time_type> times;
    for (const auto& entry : files::directory_iterator(folder))
        times[entry.path().filename().string()] = files::last_write_time(entry.path());
    return times;
}

// The files also hold the time of their writing, so what counts is their pixels.
std::map<std::string, std::vector<float>> pixels_of(const std::string& folder) {
    Registry registry;
    EXPECT_TRUE(registry.load("images"));
    const auto* images = registry.find<ImagesInterface>(k_images_interface, k_images_version);
    std::map<std::string, std::vector<float>> pixels;
    for (const auto& entry : files::directory_iterator(folder)) {
        if (entry.path().extension() != ".exr" || !images) continue;
        const auto picture = images->read_float(entry.path().string());
        EXPECT_TRUE(picture) << entry.path();
        if (picture) pixels[entry.path().filename().string()] = picture->rgb;
    }
    return pixels;
}

TEST(BenchAccuracy, LeavesAPageAndKeepsItsReferences) {
    const std::string folder = fresh_folder(), references = folder + "/cache/references";
    write_scene(folder);
    const std::vector<std::string> options{"--methods", "hybrid, measured", "--size", "64x48"};
    const ProgramResult first = bench(folder, options);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    EXPECT_NE(first.out.find(folder + "/out/index.html"), std::string::npos) << first.out;

    const json record = json::parse(read_file(folder + "/out/accuracy.json"), nullptr, false);
    ASSERT_TRUE(record.is_object());
    EXPECT_NE(record.dump().find("hybrid, measured"), std::string::npos);
    EXPECT_NE(record.dump().find("full, 1 sample"), std::string::npos);  // taken along, to compare with
    const std::string csv = read_file(folder + "/out/accuracy.csv");
    EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 9);
    const std::string page = read_file(folder + "/out/index.html");
    EXPECT_NE(page.find("test meadow"), std::string::npos);
    EXPECT_NE(page.find("view1-reference.png"), std::string::npos);
    EXPECT_TRUE(files::exists(folder + "/out/view1-reference.png"));

    const auto traced = files_of(references);
    ASSERT_EQ(traced.size(), 4u);  // three pictures and their checksums
    const auto pixels = pixels_of(references);
    ASSERT_EQ(pixels.size(), 3u);
    ASSERT_EQ(pixels.begin()->second.size(), 64u * 48u * 3u);
    const auto times = times_of(references);
    ASSERT_EQ(bench(folder, options).exit_code, 0);
    EXPECT_EQ(times_of(references), times);

    // What is damaged or missing is made again, to the same pixels, and the run goes on.
    auto expect_mended = [&](const std::string& name, const char* said) {
        SCOPED_TRACE(name + " " + said);
        const ProgramResult mended = bench(folder, options);
        EXPECT_EQ(mended.exit_code, 0) << mended.err;
        EXPECT_NE((mended.out + mended.err).find(said), std::string::npos) << mended.err;
        EXPECT_TRUE(pixels_of(references) == pixels);
        EXPECT_EQ(files_of(references).size(), 4u);
        // Whole again: the next run finds it.
        const auto times_mended = times_of(references);
        EXPECT_EQ(bench(folder, options).exit_code, 0);
        EXPECT_EQ(times_of(references), times_mended);
    };
    for (const auto& [name, unused] : traced) {
        const files::path path = references + "/" + name;
        const std::string bytes = read_file(path);
        if (name.ends_with(".json")) {
            write_file(path, "{ \"samples_per_pixel\": ");
            expect_mended(name, name.c_str());
            write_file(path, bytes + " ]");
            expect_mended(name, name.c_str());
            files::remove(path);
            expect_mended(name, "");
        } else if (name.find("-shadowed") != std::string::npos) {
            std::string flipped = bytes;
            flipped[flipped.size() / 2] = char(flipped[flipped.size() / 2] ^ 1);
            write_file(path, flipped);
            expect_mended(name, name.c_str());
            write_file(path, bytes.substr(0, bytes.size() / 2));
            expect_mended(name, name.c_str());
        } else if (name.find("-coverage") != std::string::npos) {
            files::remove(path);
            expect_mended(name, "");
        }
    }
}

// A reference belongs to its scene, view and size.
TEST(BenchAccuracy, AnotherSunHasItsOwnReference) {
    const std::string folder = fresh_folder(), references = folder + "/cache/references";
    write_scene(folder);
    const std::vector<std::string> options{"--methods", "full, 1 sample", "--size", "32x24"};
    ASSERT_EQ(bench(folder, options).exit_code, 0);
    ASSERT_EQ(files_of(references).size(), 4u);
    json evening = meadow();
    evening["sun"] = {{"azimuth_deg", 250}, {"elevation_deg", 8}};
    write_scene(folder, evening);
    ASSERT_EQ(bench(folder, options).exit_code, 0);
    EXPECT_EQ(files_of(references).size(), 8u);
}

}  // namespace
