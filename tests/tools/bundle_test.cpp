// A bundle is carried to a machine that has nothing of ours: what it draws there is what is drawn here.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>
#include <sys/wait.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/images/images.h"
#include "runtime/core/picture.h"
#include "runtime/plugin/registry.h"
#include "tests/tools/run_program.h"

namespace {

using namespace coppice;
using nlohmann::json;
namespace fs = std::filesystem;

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

// By the path inside the folder.
std::map<std::string, std::string> contents(const std::string& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = read_file(entry.path().string());
    return files;
}

// Daisies listed in a CSV and in a scene within the scene, with a path file, in folders as authors keep them.
std::string write_scene(const std::string& folder) {
    write(folder + "/species/daisy.json",
          read_file(std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json"));
    write(folder + "/survey/daisies.csv",
          "x,y,species\n0,0,daisy\n0.4,0.2,daisy\n-0.4,-0.1,daisy\n0.1,-0.9,daisy\n");
    write(folder + "/paths/fly.json",
          R"({"keys": [{"time_s": 0, "at": [0, 0.8, 3], "pitch_deg": -12, "fov_deg": 60},
                       {"time_s": 0.2, "at": [1, 0.8, 3], "pitch_deg": -12, "fov_deg": 60}]})");
    write(folder + "/scenes/parts/bed.eco.json",
          R"({"plants": {"daisy": {"source": "../../species/daisy.json"}},
              "placements": [{"plant": "daisy", "at": [0, 0]}]})");
    const std::string path = folder + "/scenes/it's a meadow.eco.json";
    write(path, R"({"name": "test meadow",
        "plants": {"daisy": {"source": "../species/daisy.json", "individuals": 6, "variations": 2,
                             "height_m": 0.2}},
        "terrain": {"flat": {"size_m": 32, "cell_m": 4}},
        "placements": [{"csv": "../survey/daisies.csv"}],
        "references": [{"scene": "parts/bed.eco.json", "at": [1, 1]}],
        "camera_path": "../paths/fly.json"})");
    return path;
}

std::vector<std::string> words(const std::string& folder, const std::string& scene,
                               std::vector<std::string> more = {}) {
    std::vector<std::string> all{"bundle",  folder + "/a bundle", "--scene", scene,
                                 "--cache", folder + "/cache/"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

struct ScriptResult {
    int exit_code;
    std::string output;
};

// In the bundle, with nothing of our environment; variables as "NAME=value NAME=value".
ScriptResult run_bundle(const std::string& bundle, const std::string& command,
                        const std::string& variables = "") {
    const std::string log = bundle + ".log";
    const int status = std::system(("cd '" + bundle + "' && env -i PATH=/usr/bin:/bin HOME=/nonexistent " +
                                    variables + " " + command + " >'" + log + "' 2>&1")
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(log)};
}

const json& figure(const json& summary, const std::string& name) {
    for (const json& one : summary.at("figures"))
        if (one.at("name") == name) return one;
    ADD_FAILURE() << "no figure " << name;
    static const json k_none{{"value", 0.0}};
    return k_none;
}

// Where the dynamic linker finds what an object of the bundle needs; of the system only glibc may be left.
void expect_complete(const std::string& bundle, const std::string& object) {
    const ScriptResult result = run_bundle(
        bundle, "/lib64/ld-linux-x86-64.so.2 --library-path lib:lib/fallback --list '" + object + "'");
    ASSERT_EQ(result.exit_code, 0) << result.output;
    std::istringstream lines(result.output);
    int ours = 0;
    for (std::string name, arrow, path, rest; lines >> name && std::getline(lines, rest);) {
        const size_t from = rest.find("=> ");
        if (from == std::string::npos) continue;  // the linker itself, and what the kernel brings
        path = rest.substr(from + 3, rest.rfind(" (") - from - 3);
        if (path.starts_with("lib/")) {
            ++ours;
            continue;
        }
        const std::string known =
            " libc.so.6 libm.so.6 libdl.so.2 libpthread.so.0 librt.so.1 libresolv.so.2 ";
        EXPECT_NE(known.find(" " + name + " "), std::string::npos) << object << " needs " << name << rest;
    }
    EXPECT_GT(ours, 0) << result.output;
}

void expect_failure(const ProgramResult& result, int exit_code, const std::string& word) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
    // One line from us, behind what loading the scene has to say.
    const size_t ours = ("\n" + result.err).find("\ncoppice: ");
    ASSERT_NE(ours, std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin() + ptrdiff_t(ours), result.err.end(), '\n'), 1) << result.err;
}

// A bundle has the size of a program, which is too much to leave behind.
class Bundle : public testing::Test {
  protected:
    void TearDown() override { fs::remove_all(folder); }
    const std::string folder = fresh_folder(), bundle = folder + "/a bundle",
                      scene = write_scene(folder + "/author");
};

}  // namespace

TEST_F(Bundle, DrawsElsewhereWhatIsDrawnHere) {
    const ProgramResult made = run_coppice(words(folder, scene));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    ASSERT_EQ(run_coppice({"play", scene, "--headless", "1280x720", "--out", folder + "/here", "--cache",
                           folder + "/cache"})
                  .exit_code,
              0);
    // Nothing of what it was made from is left.
    fs::rename(folder + "/author", folder + "/gone");
    fs::remove_all(folder + "/cache");

    const ScriptResult run = run_bundle(bundle, "./run");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const json here = json::parse(read_file(folder + "/here/summary.json")),
               there = json::parse(read_file(bundle + "/out/summary.json"));
    ASSERT_EQ(here.at("pictures").size(), there.at("pictures").size());
    ASSERT_GT(here["pictures"].size(), 1u);
    Registry registry;
    ASSERT_TRUE(registry.load("images"));
    const auto* images = registry.find<ImagesInterface>(k_images_interface, k_images_version);
    for (size_t i = 0; i < here["pictures"].size(); ++i) {
        const std::string png = here["pictures"][i]["file"], ppm = there["pictures"][i]["file"];
        EXPECT_TRUE(ppm.ends_with(".ppm")) << "the images plugin is not in the bundle";
        EXPECT_EQ(here["pictures"][i]["hash"], there["pictures"][i]["hash"]);
        const auto a = images->read(folder + "/here/" + png), b = read_ppm(bundle + "/out/" + ppm);
        ASSERT_TRUE(a.has_value() && b.has_value());
        EXPECT_TRUE(a->rgba == b->rgba) << png;
    }
    EXPECT_NE(here["pictures"][0]["hash"], here["pictures"].back()["hash"]) << "the camera moves";
    EXPECT_EQ(figure(there, "plants")["value"], 5);
    EXPECT_EQ(here["hashes"]["world"], there["hashes"]["world"]);
    EXPECT_TRUE(there["hashes"].contains("plant daisy"));
    EXPECT_FALSE(fs::is_empty(bundle + "/cache/populations")) << "measured here, not there";
    EXPECT_GE(figure(there, "pass_resolve_ms")["value"].get<double>(), 0.0);
}

TEST_F(Bundle, Measures) {
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    const ScriptResult run = run_bundle(bundle, "./run bench");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const json summary = json::parse(read_file(bundle + "/out/bench/summary.json"));
    for (const char* name : {"median_hz", "full_over_lod", "vertices", "pass_resolve_ms"})
        EXPECT_GT(figure(summary, name)["value"].get<double>(), 0.0) << name;

    const ScriptResult play = run_bundle(bundle, "./run play --headless 64x48 --out small");
    ASSERT_EQ(play.exit_code, 0) << play.output;
    EXPECT_EQ(json::parse(read_file(bundle + "/small/summary.json")).at("settings").at("width"), 64);
    EXPECT_EQ(run_bundle(bundle, "./run --version").output, "coppice " COPPICE_VERSION "\n");
    EXPECT_EQ(run_bundle(bundle, "./run inspect none.plant").exit_code, 2);
}

TEST_F(Bundle, NeedsNothingOfTheSystemButGlibcAndVulkan) {
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    expect_complete(bundle, "bin/coppice");
    for (const char* plugin : {"terrain", "modeller", "vegetation"})
        expect_complete(bundle, std::string("lib/coppice/") + plugin + ".so");
    for (const auto& entry : fs::recursive_directory_iterator(bundle)) {
        const std::string name = entry.path().filename().string();
        EXPECT_FALSE(name.starts_with("libvulkan") || name.starts_with("libc.so") ||
                     name.starts_with("libOpenImageIO") || name.starts_with("libglfw"))
            << name;
    }
    // A C++ library of the system that is too old, here one that is none, gives way to the bundle's.
    write(folder + "/old/libstdc++.so.6", "no library");
    const ScriptResult run = run_bundle(bundle, "./run --version", "LD_LIBRARY_PATH='" + folder + "/old'");
    EXPECT_EQ(run.output, "coppice " COPPICE_VERSION "\n");
}

TEST_F(Bundle, TheSameInputGivesTheSameFiles) {
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    const auto first = contents(bundle);
    fs::remove_all(bundle);
    fs::remove_all(folder + "/cache");
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    EXPECT_TRUE(first == contents(bundle));
}

TEST_F(Bundle, ReplacesABundleAndNothingElse) {
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    EXPECT_TRUE(fs::exists(bundle + "/content/survey/daisies.csv"));
    write(bundle + "/out/summary.json", "a report");
    write(bundle + "/bin/coppice", "damaged");
    fs::rename(scene, folder + "/author/scenes/other.eco.json");
    write(folder + "/author/scenes/other.eco.json", R"({"plants": {}, "placements": []})");
    ASSERT_EQ(run_coppice(words(folder, folder + "/author/scenes/other.eco.json")).exit_code, 0);
    EXPECT_FALSE(fs::exists(bundle + "/content/survey/daisies.csv")) << "of the bundle before";
    EXPECT_FALSE(fs::exists(bundle + "/cache/plants") && !fs::is_empty(bundle + "/cache/plants"));
    EXPECT_EQ(read_file(bundle + "/out/summary.json"), "a report");
    EXPECT_EQ(run_bundle(bundle, "./run --version").exit_code, 0);

    // A list that somebody edited never leads out of the folder.
    write(folder + "/precious", "mine");
    write(bundle + "/bundle.json", R"({"format": "coppice bundle", "files": ["../precious"]})");
    expect_failure(run_coppice(words(folder, scene)), 2, "bundle.json");
    EXPECT_EQ(read_file(folder + "/precious"), "mine");
}

TEST_F(Bundle, AFolderThatIsNoBundleIsLeftAlone) {
    write(bundle + "/letter.txt", "mine");
    expect_failure(run_coppice(words(folder, scene)), 2, "a bundle");
    EXPECT_EQ(std::distance(fs::directory_iterator(bundle), {}), 1);
    EXPECT_FALSE(fs::exists(folder + "/cache")) << "plants were cooked for nothing";

    for (const char* list : {"", "[", "[]", "{}", R"({"format": "coppice bundle"})",
                             R"({"format": 3, "files": []})", R"({"format": "coppice bundle", "files": [1]})",
                             R"({"format": "coppice bundle", "files": ["/etc/passwd"]})",
                             R"({"format": "coppice bundle", "files": ["a/../../b"]})"}) {
        write(bundle + "/bundle.json", list);
        expect_failure(run_coppice(words(folder, scene)), 2, "bundle.json");
    }
    fs::remove_all(bundle);
    write(bundle, "a file");
    expect_failure(run_coppice(words(folder, scene)), 2, "a bundle");
    EXPECT_EQ(read_file(bundle), "a file");
}

TEST_F(Bundle, TooLargeIsRefusedAndSaysWhatIsLargest) {
    const ProgramResult result = run_coppice(words(folder, scene, {"--limit-mib", "1"}));
    expect_failure(result, 1, "the largest is bin/coppice");
    EXPECT_NE(result.out.find("cooked"), std::string::npos) << result.out;
    EXPECT_FALSE(fs::exists(bundle));
    expect_failure(run_coppice(words(folder, scene, {"--limit-mib", "0"})), 2, "--limit-mib");
}

TEST_F(Bundle, AFileNamedByAnAbsolutePathIsRefused) {
    std::string text = read_file(scene);
    text.replace(text.find("../survey"), 9, folder + "/author/survey");
    write(scene, text);
    expect_failure(run_coppice(words(folder, scene)), 2, "survey/daisies.csv");
    EXPECT_FALSE(fs::exists(bundle));
}

TEST_F(Bundle, ABrokenOrMissingSceneIsBadInput) {
    expect_failure(run_coppice(words(folder, "no_such_scene")), 2, "no_such_scene");
    fs::remove(folder + "/author/paths/fly.json");
    expect_failure(run_coppice(words(folder, scene)), 2, folder + "/author/paths/fly.json");
    write(scene, "{");
    expect_failure(run_coppice(words(folder, scene)), 2, "it's a meadow");
    EXPECT_FALSE(fs::exists(bundle));
}

TEST_F(Bundle, ACacheThatCannotBeWrittenLeavesNoBundleWithoutPlants) {
    write(folder + "/cache", "a file");
    const ProgramResult result = run_coppice(words(folder, scene));
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_NE(result.err.find("--cache"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(bundle));
}

TEST_F(Bundle, AFullDiskIsAnErrorAndTheNextTryGoesOn) {
    ASSERT_EQ(run_coppice(words(folder, scene)).exit_code, 0);
    const auto before = contents(bundle);
    std::string command =
        "trap '' XFSZ; ulimit -f 200; exec '" COPPICE_PROGRAM "'";  // files of at most 100 KiB
    for (const std::string& word : words(folder, folder + "/author/scenes/m.eco.json"))
        command += " \"" + word + "\"";
    fs::rename(scene, folder + "/author/scenes/m.eco.json");
    write(folder + "/script", command + " 2>'" + folder + "/err'\n");
    const int status = std::system(("sh '" + folder + "/script' >/dev/null").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1);
    const std::string err = read_file(folder + "/err");
    EXPECT_NE(err.find("write-failed"), std::string::npos) << err;
    auto after = contents(bundle);
    EXPECT_NE(after["bundle.json"], before.at("bundle.json")) << "it knows the new files, too";
    after["bundle.json"] = before.at("bundle.json");
    EXPECT_TRUE(after == before) << "the old files are whole, and nothing lies beside them";

    ASSERT_EQ(run_coppice(words(folder, folder + "/author/scenes/m.eco.json")).exit_code, 0);
    EXPECT_TRUE(fs::exists(bundle + "/content/scenes/m.eco.json"));
    EXPECT_FALSE(fs::exists(bundle + "/content/scenes/it's a meadow.eco.json"));
}

TEST_F(Bundle, APlantAloneIsBundledCookedOrNot) {
    const std::string packed = folder + "/daisy.plant";
    const std::string species = folder + "/author/species/daisy.json";
    ASSERT_EQ(run_coppice({"cook", species, "-o", packed}).exit_code, 0);
    std::vector<json> pictures;
    for (const std::string& plant : {species, packed}) {
        const ProgramResult made = run_coppice(words(folder, plant));
        ASSERT_EQ(made.exit_code, 0) << made.err;
        const ScriptResult run =
            run_bundle(bundle, "./run play --headless 96x64 --frames 2 --pictures 2 --out out");
        ASSERT_EQ(run.exit_code, 0) << run.output;
        pictures.push_back(json::parse(read_file(bundle + "/out/summary.json")).at("pictures"));
    }
    EXPECT_EQ(pictures[0], pictures[1]);
}

TEST_F(Bundle, APopulatedSceneIsDrawnElsewhereAsHere) {
    const std::string populated = folder + "/author/a populated meadow";
    ASSERT_EQ(run_coppice({"populate", scene, "-o", populated, "--cache", folder + "/cache"}).exit_code, 0);
    fs::remove_all(folder + "/cache");
    const ProgramResult made = run_coppice(words(folder, populated));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_NE(made.out.find("populated scene"), std::string::npos) << made.out;
    EXPECT_FALSE(fs::exists(folder + "/cache")) << "nothing had to be cooked";
    ASSERT_EQ(run_coppice({"play", populated, "--headless", "1280x720", "--out", folder + "/here",
                           "--wait-for-tiles"})
                  .exit_code,
              0);
    fs::remove_all(folder + "/author");

    const ScriptResult run = run_bundle(bundle, "./run play --headless 1280x720 --out out --wait-for-tiles");
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const json here = json::parse(read_file(folder + "/here/summary.json")),
               there = json::parse(read_file(bundle + "/out/summary.json"));
    ASSERT_GT(here["pictures"].size(), 1u);
    ASSERT_EQ(here["pictures"].size(), there["pictures"].size());
    for (size_t i = 0; i < here["pictures"].size(); ++i)
        EXPECT_EQ(here["pictures"][i]["hash"], there["pictures"][i]["hash"]);
    EXPECT_NE(here["pictures"][0]["hash"], here["pictures"].back()["hash"]) << "the camera moves";
    EXPECT_EQ(figure(there, "plants")["value"], 5);
    // Also as the script has it.
    const ScriptResult flown = run_bundle(bundle, "./run"), measured = run_bundle(bundle, "./run bench");
    EXPECT_EQ(flown.exit_code, 0) << flown.output;
    EXPECT_EQ(measured.exit_code, 0) << measured.output;
    EXPECT_TRUE(fs::exists(bundle + "/out/bench/summary.json"));
}

TEST_F(Bundle, APopulatedSceneThatIsBrokenOrOverAStatedLimitIsRefused) {
    const std::string populated = folder + "/author/populated";
    ASSERT_EQ(run_coppice({"populate", scene, "-o", populated, "--cache", folder + "/cache"}).exit_code, 0);
    expect_failure(run_coppice(words(folder, populated, {"--limit-mib", "1"})), 1, "--limit-mib");
    EXPECT_FALSE(fs::exists(bundle));
    std::string pack;
    for (const auto& entry : fs::recursive_directory_iterator(populated))
        if (entry.path().extension() == ".tiles") pack = entry.path().string();
    std::string bytes = read_file(pack);
    bytes[bytes.size() - 70] ^= 1;
    write(pack, bytes);
    expect_failure(run_coppice(words(folder, populated)), 2, pack.substr(pack.rfind('/')));
    fs::remove(pack);
    expect_failure(run_coppice(words(folder, populated + "/scene.json")), 2, pack.substr(pack.rfind('/')));
    expect_failure(run_coppice(words(folder, folder + "/author/species")), 2, "scene.json");
    EXPECT_FALSE(fs::exists(bundle));
}
