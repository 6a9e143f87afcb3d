// Populating as a user does it: in one go, in pieces, by ninja, after an interruption, onto a full disk.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>
#include <sys/resource.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "tests/tools/run_program.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

// By the path inside the folder.
Files contents(const std::string& folder) {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = read_file(entry.path().string());
    return files;
}

std::vector<std::string> names(const Files& files) {
    std::vector<std::string> names;
    for (const auto& [name, text] : files) names.push_back(name);
    return names;
}

class Populate : public testing::Test {
  protected:
    // 2,600 daisies of two shapes on ground from a file, in packs of at most 1,000.
    Populate()
        : folder_(fresh_folder()), scene_(folder_ + "/it's a meadow.eco.json"), out_(folder_ + "/out 1") {
        fs::copy_file(std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json",
                      folder_ + "/daisy.json");
        // 3 x 3 samples of 16 bits, so the ground is not flat.
        write(folder_ + "/ground.pgm",
              std::string("P5\n3 3\n65535\n") + std::string("\x01\x00\x02\x00\x03\x00\x01\x00"
                                                            "\x09\x00\x02\x00\x01\x00\x02\x00"
                                                            "\x01\x00",
                                                            18));
        write_scene(2600);
    }
    ~Populate() override { fs::remove_all(folder_); }

    void write_scene(int count) {
        write(scene_, R"({"name": "test meadow",
            "plants": {"daisy": {"source": "daisy.json", "variations": 2}},
            "terrain": {"heights": {"file": "ground.pgm", "cell_m": 20, "highest_m": 30}},
            "placements": [{"scatter": {"plant": "daisy", "count": )" +
                          std::to_string(count) + R"(,
                            "scale": [4, 6], "region": {"circle": {"center": [0, 0], "radius_m": 18}}}}],
            "sun": {"azimuth_deg": 100, "elevation_deg": 30}})");
    }
    std::vector<std::string> words(const std::string& out, std::vector<std::string> more = {}) const {
        std::vector<std::string> all{"populate", scene_, "-o", out, "--pack-plants", "1000"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    ProgramResult populate(const std::string& out, std::vector<std::string> more = {}) const {
        return run_coppice(words(out, std::move(more)));
    }

    std::string folder_, scene_, out_;
};

// A picture, through the images plugin or without it, is what a scene is made of; so are colours.
TEST_F(Populate, MapsAndColoursAreWhatPacksAreMadeOf) {
    auto write_with = [&](const std::string& plant, const std::string& scatter) {
        write(scene_, R"({"plants": {"daisy": {"source": "daisy.json")" + plant + R"(}},
            "placements": [{"scatter": {"plant": "daisy", "count": 600, "region": {"circle": {"center": [0, 0], "radius_m": 18}})" +
                          scatter + "}}]}");
    };
    const std::string map = R"(, "density_map": {"picture": "map.pgm", "center": [0, 0], "size_m": [40, 40]})";
    write_with("", map);
    write(folder_ + "/map.pgm", "P5 2 1 255 " + std::string("\xff\x00", 2));
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files first = contents(out_);
    ASSERT_EQ(populate(out_).exit_code, 0);
    EXPECT_EQ(contents(out_), first);
    write(folder_ + "/map.pgm", "P5 2 1 255 " + std::string("\x00\xff", 2));
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files second = contents(out_);
    EXPECT_NE(second, first);
    write_with(R"(, "color_variation": {"brightness": 0.3})", map);
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files varied = contents(out_);
    EXPECT_NE(varied, second);
    EXPECT_NE(varied.at("scene.json").find("color_variation"), std::string::npos);
    // A build knows the picture as an input.
    const std::string ninja = folder_ + "/build.ninja";
    ASSERT_EQ(populate(out_, {"--ninja", ninja}).exit_code, 0);
    EXPECT_NE(read_file(ninja).find("map.pgm"), std::string::npos);
    write(folder_ + "/map.pgm", "P5 2 1 255 x");
    const ProgramResult broken = populate(out_);
    EXPECT_EQ(broken.exit_code, 2);
    EXPECT_NE(broken.err.find("density_map.picture"), std::string::npos) << broken.err;
}

TEST_F(Populate, GivesAPlayerAllOfTheScene) {
    const ProgramResult result = populate(out_);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("2 plants: 2 made, 0 kept"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("2.6 k plants"), std::string::npos) << result.out;

    constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    auto authored = load_scene(scene_, {&k_terrain});
    ASSERT_TRUE(authored) << to_string(authored.error());

    // Carried away, with what it was made of gone.
    const std::string elsewhere = folder_ + "/elsewhere";
    fs::rename(out_, elsewhere);
    fs::remove(folder_ + "/ground.pgm");
    auto populated = load_populated_scene(elsewhere + "/scene.json", &k_terrain);
    ASSERT_TRUE(populated) << to_string(populated.error());
    EXPECT_EQ(populated->scene.name, "test meadow");
    ASSERT_TRUE(populated->scene.terrain);
    ASSERT_EQ(populated->scene.models.size(), 2u);
    std::vector<Plant> plants;
    for (const SceneModel& model : populated->scene.models) {
        auto plant = load_plant(model.source_path);
        ASSERT_TRUE(plant) << to_string(plant.error());
        plants.push_back(std::move(*plant));
    }
    // The ground is as dark under the plants as where all of them are at hand.
    std::vector<Box> bounds;
    for (const Plant& plant : plants) bounds.push_back(plant.bounds_plant);
    const std::vector<std::byte> bare = authored->terrain->pack().bytes;
    shade_ground(*authored, *authored->terrain, bounds);
    EXPECT_NE(authored->terrain->pack().bytes, bare);
    const auto ground = populated->scene.terrain->vertices(), expected = authored->terrain->vertices();
    ASSERT_EQ(ground.size(), expected.size());
    EXPECT_EQ(std::memcmp(ground.data(), expected.data(), ground.size_bytes()), 0);

    EXPECT_TRUE(check_plants(*populated, plants));
    auto packs = open_packs(*populated);
    ASSERT_TRUE(packs) << to_string(packs.error());
    ASSERT_GE(packs->size(), 3u);
    uint64_t plant_count = 0, triangle_count = 0;
    for (size_t p = 0; p < packs->size(); ++p) {
        const TilePack& pack = (*packs)[p];
        EXPECT_TRUE(check_blocks(pack));
        EXPECT_LE(pack.nodes[0].plant_count, 1000u);
        EXPECT_GT(pack.nodes[0].cloud.item_count, 100u);
        EXPECT_EQ(populated->packs[p].triangle_count, pack.nodes[0].triangle_count);
        plant_count += pack.nodes[0].plant_count;
        for (uint32_t n = 0; n < pack.nodes.size(); ++n) {
            const auto rows = read_plants(pack, n);
            ASSERT_TRUE(rows);
            for (const PlantModel& plant : rows->models)
                triangle_count += plants[plant.model].triangle_vertices.size() / 3;
        }
    }
    EXPECT_EQ(plant_count, 2600u);
    uint64_t announced = 0;
    for (const ScenePack& pack : populated->packs) announced += pack.triangle_count;
    EXPECT_EQ(triangle_count, announced);
}

TEST_F(Populate, MakesTheSameBytesEveryTimeAndOnlyWhatIsMissing) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files first = contents(out_);
    ASSERT_EQ(populate(folder_ + "/b").exit_code, 0);
    EXPECT_EQ(contents(folder_ + "/b"), first);

    std::map<std::string, fs::file_time_type> times;
    for (const auto& [name, text] : first) times[name] = fs::last_write_time(out_ + "/" + name);
    const std::string damaged = "tiles/it's a meadow-1.tiles";
    ASSERT_TRUE(first.contains(damaged)) << testing::PrintToString(names(first));
    std::string bytes = first.at(damaged);
    bytes[bytes.size() - 70] ^= 4;  // in the last block
    write(out_ + "/" + damaged, bytes);
    const std::string missing = names(first)[0];  // a plant
    ASSERT_TRUE(missing.starts_with("plants/daisy-"));
    fs::remove(out_ + "/" + missing);
    const ProgramResult again = populate(out_);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NE(again.out.find("2 plants: 1 made, 1 kept"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("meadow-0.tiles: kept"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("meadow-1.tiles: made"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("scene.json: kept"), std::string::npos) << again.out;
    EXPECT_EQ(contents(out_), first);
    for (const auto& [name, time] : times) {
        if (name == damaged || name == missing) continue;
        EXPECT_EQ(fs::last_write_time(out_ + "/" + name), time) << name;
    }
}

TEST_F(Populate, PiecesMadeOneByOneAreTheSame) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files whole = contents(out_);
    const std::string pieces = folder_ + "/pieces";
    std::vector<std::string> packs;
    for (const auto& [name, text] : whole) {
        if (name.starts_with("tiles/")) packs.push_back(name);
        if (name.starts_with("plants/")) {
            ASSERT_EQ(populate(pieces, {"--only", name}).exit_code, 0) << name;
        }
    }
    std::reverse(packs.begin(), packs.end());
    for (const std::string& name : packs) ASSERT_EQ(populate(pieces, {"--only", name}).exit_code, 0) << name;
    ASSERT_EQ(populate(pieces, {"--only", "scene.json"}).exit_code, 0);
    EXPECT_EQ(contents(pieces), whole);
}

TEST_F(Populate, NinjaMakesTheSameAndKnowsWhenNothingIsToBeDone) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const std::string by_ninja = folder_ + "/by ninja: $1", file = folder_ + "/a build.ninja";
    auto ninja = [&] {
        const std::string log = folder_ + "/ninja.log";
        const int status =
            std::system(("cd '" + folder_ + "' && ninja -f '" + file + "' > '" + log + "' 2>&1").c_str());
        EXPECT_EQ(status, 0) << read_file(log);
        return read_file(log);
    };
    const ProgramResult listed = populate(by_ninja, {"--ninja", file});
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    EXPECT_FALSE(fs::exists(by_ninja)) << "something was made already";
    ninja();
    EXPECT_EQ(contents(by_ninja), contents(out_));
    EXPECT_NE(ninja().find("no work to do"), std::string::npos);

    // After a change the list is made anew by itself.
    write_scene(1500);
    ninja();
    ASSERT_EQ(populate(folder_ + "/changed").exit_code, 0);
    Files changed = contents(by_ninja);
    for (const auto& [name, text] : contents(folder_ + "/changed"))
        EXPECT_TRUE(changed[name] == text) << name;
    EXPECT_NE(ninja().find("no work to do"), std::string::npos);
}

TEST_F(Populate, ABrokenGroundIsRefusedAndMadeAgain) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files sound = contents(out_);
    std::string ground;
    for (const std::string& name : names(sound))
        if (name.ends_with(".ground")) ground = name;
    ASSERT_TRUE(ground.starts_with("terrain/it's a meadow-")) << testing::PrintToString(names(sound));
    std::string flipped = sound.at(ground);
    flipped[flipped.size() / 2] ^= 16;
    for (const std::string& broken : {flipped, sound.at(ground).substr(0, 100), std::string()}) {
        write(out_ + "/" + ground, broken);
        const ProgramResult played = run_coppice({"play", out_, "--headless", "32x32"});
        EXPECT_EQ(played.exit_code, 2);
        EXPECT_NE(played.err.find(ground), std::string::npos) << played.err;
        ASSERT_EQ(populate(out_).exit_code, 0);
        EXPECT_EQ(contents(out_), sound);
    }
}

TEST_F(Populate, AFolderOfAnotherVersionIsRefusedAndMadeAgain) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files sound = contents(out_);
    std::string older = sound.at("scene.json");
    older.replace(older.find("\"populated\": 3"), 14, "\"populated\": 2");
    write(out_ + "/scene.json", older);
    const ProgramResult played = run_coppice({"play", out_, "--headless", "32x32"});
    EXPECT_EQ(played.exit_code, 2);
    EXPECT_NE(played.err.find("populate the scene again"), std::string::npos) << played.err;
    ASSERT_EQ(populate(out_).exit_code, 0);
    EXPECT_EQ(contents(out_), sound);
}

TEST_F(Populate, AFullDiskLeavesOldFilesAndSaysSo) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files before = contents(out_);
    write_scene(2500);
    rlimit old_limit{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    auto* old_handler =
        std::signal(SIGXFSZ, SIG_IGN);  // which the program inherits, as a full disk sends no signal
    const rlimit small{20000, old_limit.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const ProgramResult result = populate(out_);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_NE(result.err.find("write-failed"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(".tiles"), std::string::npos) << result.err;
    EXPECT_EQ(contents(out_), before);
}

// A field and a hill that share their daisies, 1 x 2 of each in a county, and 2 x 1 counties beside one more field.
class PopulateMosaic : public testing::Test {
  protected:
    PopulateMosaic() : folder_(fresh_folder()), scene_(folder_ + "/land.eco.json"), out_(folder_ + "/out") {
        fs::copy_file(std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json",
                      folder_ + "/daisy.json");
        write_scene("field", 1100, 1.0);
        write_scene("hill", 300, 6.5);
        write(folder_ + "/parts/county.eco.json", R"({"mosaic": [
            {"scene": "field.eco.json", "at": [-32, 0], "grid": {"columns": 1, "rows": 2, "spacing_m": 64}},
            {"scene": "hill.eco.json", "at": [32, 0], "grid": {"columns": 1, "rows": 2, "spacing_m": 64}}]})");
        write(scene_, R"({"name": "test land", "mosaic": [
            {"scene": "parts/county.eco.json", "grid": {"columns": 2, "rows": 1, "spacing_m": 128}},
            {"scene": "parts/field.eco.json", "at": [1000, -96]}],
            "sun": {"azimuth_deg": 100, "elevation_deg": 30}, "haze": {"density_per_m": 0.0002},
            "camera_path": "flight.json", "sample_distance_px": 1.5})");
        write(folder_ + "/flight.json", R"({"keys": [
            {"time_s": 0, "at": [-96, 10], "above_m": 2}, {"time_s": 9, "at": [100, 10], "above_m": 2}]})");
    }
    ~PopulateMosaic() override { fs::remove_all(folder_); }

    void write_scene(const std::string& name, int count, double height_m) {
        write(folder_ + "/parts/" + name + ".eco.json",
              R"({"plants": {"daisy": {"source": "../daisy.json"}},
                  "terrain": {"flat": {"size_m": 64, "cell_m": 4, "height_m": )" +
                  std::to_string(height_m) + R"(}},
                  "placements": [{"scatter": {"plant": "daisy", "count": )" +
                  std::to_string(count) + R"(, "scale": [4, 6],
                      "region": {"circle": {"center": [0, 0], "radius_m": 18}}}}]})");
    }
    ProgramResult populate(const std::string& out, std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"populate", scene_, "-o", out, "--pack-plants", "600"};
        words.insert(words.end(), more.begin(), more.end());
        return run_coppice(words);
    }

    std::string folder_, scene_, out_;
};

TEST_F(PopulateMosaic, GivesAPlayerEverySceneOnce) {
    const ProgramResult result = populate(out_);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    // 5 fields of 1,100 and 4 hills of 300.
    EXPECT_NE(result.out.find("6.7 k plants"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("2 different scenes in 9 places"), std::string::npos) << result.out;
    size_t folders = 0, plants = 0, scenes = 0, packs = 0;
    for (const auto& entry : fs::directory_iterator(out_)) folders += entry.is_directory();
    for (const auto& [name, text] : contents(out_)) {
        plants += name.ends_with(".plant");
        scenes += name.ends_with("scene.json");
        packs += name.ends_with(".tiles");
    }
    EXPECT_EQ(folders, 4u) << "three scenes below, and the plants they share";
    EXPECT_EQ(plants, 1u);
    EXPECT_EQ(scenes, 4u);

    // Carried away, with what it was made of gone.
    const std::string elsewhere = folder_ + "/elsewhere";
    fs::rename(out_, elsewhere);
    fs::remove_all(folder_ + "/parts");
    constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    const auto forest = load_forest(elsewhere + "/scene.json", &k_terrain);
    ASSERT_TRUE(forest) << to_string(forest.error());
    EXPECT_EQ(forest->name, "test land");
    EXPECT_EQ(forest->rows[0].plant_count, 6700u);
    EXPECT_GE(packs, 3u);
    EXPECT_EQ(forest->packs.size(), packs);
    ASSERT_EQ(forest->models.size(), 1u);
    const auto daisy = load_plant(forest->models[0].source_path);
    ASSERT_TRUE(daisy) << to_string(daisy.error());
    EXPECT_EQ(forest->rows[0].triangle_count, 6700u * (daisy->triangle_vertices.size() / 3));
    EXPECT_EQ(forest->light.haze_density_per_m, 0.0002f);
    EXPECT_EQ(forest->sample_distance_px, 1.5f);
    ASSERT_EQ(forest->camera_path.size(), 2u);
    EXPECT_NEAR(forest->camera_path[0].camera.position_world.y, 3.0, 1e-5) << "above the field";
    EXPECT_NEAR(forest->camera_path[1].camera.position_world.y, 8.5, 1e-5) << "above the hill";
    EXPECT_FALSE(forest->grounds[0].without_gaps) << "a field stands alone";

    // Each below can be flown over as well.
    for (const auto& entry : fs::directory_iterator(elsewhere)) {
        if (!fs::exists(entry.path() / "scene.json")) continue;
        const auto below = load_forest((entry.path() / "scene.json").string(), &k_terrain);
        ASSERT_TRUE(below) << to_string(below.error());
        EXPECT_TRUE(below->grounds.at(0).without_gaps);
    }
}

TEST_F(PopulateMosaic, MakesTheSameBytesEveryTimeAndOnlyWhatIsMissing) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files first = contents(out_);
    // Where all of it lies means nothing.
    fs::create_directories(folder_ + "/moved");
    for (const char* name : {"land.eco.json", "flight.json", "daisy.json", "parts"})
        fs::copy(folder_ + "/" + name, folder_ + "/moved/" + name, fs::copy_options::recursive);
    ASSERT_EQ(
        run_coppice({"populate", folder_ + "/moved/land.eco.json", "-o", out_ + "2", "--pack-plants", "600"})
            .exit_code,
        0);
    EXPECT_EQ(contents(out_ + "2"), first);

    std::map<std::string, fs::file_time_type> times;
    for (const auto& [name, text] : first) times[name] = fs::last_write_time(out_ + "/" + name);
    const ProgramResult again = populate(out_);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.out.find(": made"), std::string::npos) << again.out;
    EXPECT_EQ(again.out.find("1 made"), std::string::npos) << again.out;
    for (const auto& [name, time] : times) EXPECT_EQ(fs::last_write_time(out_ + "/" + name), time) << name;

    // A scene that changes takes the mosaics above it along, and leaves the other as it is.
    write_scene("hill", 310, 6.5);
    const ProgramResult changed = populate(out_);
    ASSERT_EQ(changed.exit_code, 0) << changed.err;
    for (const auto& [name, text] : contents(out_)) {
        if (name.starts_with("field")) {
            EXPECT_EQ(text, first.at(name)) << name;
        } else if (name.ends_with("scene.json")) {
            EXPECT_NE(text, first.at(name)) << name;
        }
    }
}

TEST_F(PopulateMosaic, PiecesMadeByNinjaOrOneByOneAreTheSame) {
    ASSERT_EQ(populate(out_).exit_code, 0);
    const Files whole = contents(out_);
    const std::string file = folder_ + "/build.ninja", by_ninja = folder_ + "/by ninja";
    const ProgramResult listed = populate(by_ninja, {"--ninja", file});
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    auto ninja = [&] {
        const std::string log = folder_ + "/ninja.log";
        const int status = std::system(("ninja -f '" + file + "' > '" + log + "' 2>&1").c_str());
        EXPECT_EQ(status, 0) << read_file(log);
        return read_file(log);
    };
    ninja();
    EXPECT_EQ(contents(by_ninja), whole);
    EXPECT_NE(ninja().find("no work to do"), std::string::npos);
    write_scene("hill", 310, 6.5);
    ninja();
    ASSERT_EQ(populate(folder_ + "/changed").exit_code, 0);
    Files changed = contents(by_ninja);
    for (const auto& [name, text] : contents(folder_ + "/changed"))
        EXPECT_TRUE(changed[name] == text) << name;

    const ProgramResult unknown = populate(out_, {"--only", "field/scene.json"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("field/scene.json"), std::string::npos) << unknown.err;
    const ProgramResult early = populate(folder_ + "/early", {"--only", "scene.json"});
    EXPECT_EQ(early.exit_code, 2);
    EXPECT_NE(early.err.find("scene.json"), std::string::npos) << early.err;
}

TEST_F(PopulateMosaic, IsNotLoadedAsAWhole) {
    const ProgramResult played = run_coppice({"play", scene_, "--headless", "32x32", "--out", out_});
    EXPECT_EQ(played.exit_code, 2);
    EXPECT_NE(played.err.find("coppice populate"), std::string::npos) << played.err;
}

TEST_F(Populate, SaysWhatIsWrong) {
    const ProgramResult unknown = populate(out_, {"--only", "tiles/meadow-9.tiles"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("tiles/meadow-9.tiles"), std::string::npos) << unknown.err;
    const ProgramResult early = populate(out_, {"--only", "scene.json"});
    EXPECT_EQ(early.exit_code, 2);
    EXPECT_NE(early.err.find("plants/daisy-"), std::string::npos) << early.err;
    EXPECT_EQ(run_coppice({"populate", folder_ + "/no.eco.json", "-o", out_}).exit_code, 2);
    EXPECT_EQ(run_coppice({"populate", folder_ + "/daisy.glb", "-o", out_}).exit_code, 2);
    EXPECT_EQ(run_coppice({"populate", scene_}).exit_code, 2);
    EXPECT_EQ(populate(scene_ + "/below").exit_code, 1) << "a folder inside a file";
    EXPECT_FALSE(fs::exists(out_));
}

}  // namespace
