// Populated scenes as a user flies over them: the same pictures as from memory, small memory, broken tiles, far places.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/eco/tile_pack.h"
#include "tests/tools/run_program.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

constexpr int k_frames = 6;  // a key of the path each

void write(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

// Where a plant is 30 px tall, then on to where all of them are a few points.
std::string flight(double x, double z) {
    std::string keys;
    for (int k = 0; k < k_frames; ++k) {
        const double away = 2.0 * double(1 << (2 * k));
        keys += (k ? ", " : "") + nlohmann::json{{"time_s", k},
                                                 {"at", {x, z + away}},
                                                 {"above_m", 1.0 + 0.25 * away},
                                                 {"yaw_deg", 0},
                                                 {"pitch_deg", -14}}
                                      .dump();
    }
    return "[" + keys + "]";
}

class Streamed : public testing::Test {
  protected:
    Streamed() : folder_(fresh_folder()), scene_(folder_ + "/meadow.eco.json"), out_(folder_ + "/out") {
        fs::copy_file(std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json",
                      folder_ + "/daisy.json");
        write(scene_, R"({"name": "meadow", "plants": {"daisy": {"source": "daisy.json", "variations": 2}},
            "terrain": {"procedural": {"size_m": 256, "cell_m": 4, "seed": 2, "periodic": true, "amplitude_m": 5,
                                       "wavelength_m": 64}},
            "placements": [{"scatter": {"plant": "daisy", "count": 6000, "scale": [4, 6],
                            "region": {"rectangle": {"center": [0, 0], "size_m": [256, 256]}}}}],
            "camera_path": )" +
                          flight(0, 0) + "}");
    }
    ~Streamed() override { fs::remove_all(folder_); }

    void populate(const std::string& scene, const std::string& out) {
        const ProgramResult result =
            run_coppice({"populate", scene, "-o", out, "--cache", folder_ + "/cache"});
        ASSERT_EQ(result.exit_code, 0) << result.err;
    }
    struct Played {
        ProgramResult result;
        nlohmann::json summary;
        double value(const std::string& name) const {
            for (const auto& figure : summary.at("figures"))
                if (figure.at("name") == name) return figure.at("value").get<double>();
            ADD_FAILURE() << name;
            return 0.0;
        }
        std::vector<std::string> hashes() const {
            std::vector<std::string> all;
            for (const auto& picture : summary.at("pictures")) all.push_back(picture.at("hash"));
            return all;
        }
    };
    Played play(const std::string& scene, std::vector<std::string> more = {}) {
        const std::string out = folder_ + "/played";
        std::vector<std::string> words{"play",
                                       scene,
                                       "--headless",
                                       "160x120",
                                       "--out",
                                       out,
                                       "--fps",
                                       "1",
                                       "--sample-distance",
                                       "2",
                                       "--cache",
                                       folder_ + "/cache",
                                       "--frames",
                                       std::to_string(k_frames),
                                       "--pictures",
                                       std::to_string(k_frames)};
        words.insert(words.end(), more.begin(), more.end());
        Played played{run_coppice(words), {}};
        EXPECT_EQ(played.result.exit_code, 0) << played.result.err;
        std::ifstream stream(out + "/summary.json");
        played.summary = nlohmann::json::parse(stream, nullptr, false);
        fs::remove_all(out);
        return played;
    }
    std::string pack() const {
        for (const auto& entry : fs::recursive_directory_iterator(out_))
            if (entry.path().extension() == ".tiles") return entry.path().string();
        return "";
    }

    std::string folder_, scene_, out_;
};

TEST_F(Streamed, PicturesAreThoseOfTheSceneInMemory) {
    populate(scene_, out_);
    const Played memory = play(scene_);
    const Played streamed = play(out_, {"--wait-for-tiles", "--validation"});
    ASSERT_EQ(memory.hashes().size(), size_t(k_frames));
    EXPECT_EQ(streamed.hashes(), memory.hashes());
    EXPECT_EQ(streamed.value("tiles_missing_frames"), 0.0);
    EXPECT_EQ(streamed.value("validation_messages"), 0.0);
    EXPECT_EQ(streamed.value("vertices"), memory.value("vertices"));
    EXPECT_GT(streamed.value("stream_read_mib"), 0.1);
    std::vector<std::string> different = memory.hashes();
    std::sort(different.begin(), different.end());
    EXPECT_EQ(std::unique(different.begin(), different.end()), different.end()) << "pictures of nothing";
}

TEST_F(Streamed, WithoutWaitingTheFlightGoesOn) {
    populate(scene_, out_);
    const Played streamed = play(out_, {"--validation"});
    EXPECT_EQ(streamed.hashes().size(), size_t(k_frames));
    EXPECT_EQ(streamed.value("validation_messages"), 0.0);
    EXPECT_GT(streamed.value("vertices"), 0.0);
}

TEST_F(Streamed, MemoryIsHeld) {
    populate(scene_, out_);
    const Played little = play(out_, {"--wait-for-tiles", "--tile-memory", "1"});
    const Played enough = play(out_, {"--wait-for-tiles"});
    EXPECT_GT(enough.value("stream_resident_mib"), 1.0)
        << "1 MiB would have been enough: the test says nothing";
    EXPECT_LE(little.value("stream_resident_mib"), 1.0);
    EXPECT_LT(little.value("device_memory_mib"), enough.value("device_memory_mib"));
    EXPECT_GT(little.value("vertices"), 0.0);
}

TEST_F(Streamed, BrokenTilesAreReportedOnceAndWhatIsAboveStandsIn) {
    populate(scene_, out_);
    const std::vector<std::string> whole = play(out_, {"--wait-for-tiles"}).hashes();
    const auto tiles = open_tile_pack(pack());
    ASSERT_TRUE(tiles) << to_string(tiles.error());
    ASSERT_GT(tiles->nodes.size(), 4u);
    // A bit of all blocks but the root's cloud, which is read with the scene.
    std::fstream file(pack(), std::ios::in | std::ios::out | std::ios::binary);
    for (size_t n = 0; n < tiles->nodes.size(); ++n)
        for (const TileBlockKind kind : {TileBlockKind::cloud, TileBlockKind::plants}) {
            const TileBlockPlace& block = block_of(tiles->nodes[n], kind);
            if (block.item_count == 0 || (n == 0 && kind == TileBlockKind::cloud)) continue;
            const uint64_t at = block.offset_bytes + block.stored_bytes / 2;
            char byte = 0;
            file.seekg(std::streamoff(at));
            file.get(byte);
            file.seekp(std::streamoff(at));
            file.put(char(byte ^ 0x10));
        }
    file.close();
    const Played broken = play(out_, {"--wait-for-tiles"});
    EXPECT_EQ(broken.hashes().size(), size_t(k_frames));
    EXPECT_NE(broken.hashes(), whole) << "nothing was broken";
    EXPECT_GT(broken.value("vertices"), 0.0) << "the root stands in";
    const std::string& said = broken.result.err;
    size_t warnings = 0;
    for (size_t at = 0; (at = said.find("stands in for it", at)) != std::string::npos; ++at) ++warnings;
    EXPECT_GT(warnings, 0u);
    EXPECT_LT(warnings, 2 * tiles->nodes.size()) << "once a block";
    EXPECT_NE(said.find(pack()), std::string::npos) << said;
}

TEST_F(Streamed, AMosaicIsTheSameAnywhere) {
    std::vector<std::string> at_origin;
    for (double offset_m : {0.0, 1.0e7}) {
        const std::string mosaic = folder_ + "/world.eco.json";
        write(mosaic, nlohmann::json{{"name", "world"},
                                     {"mosaic",
                                      {{{"scene", "meadow.eco.json"},
                                        {"at", {offset_m, -offset_m}},
                                        {"grid", {{"columns", 3}, {"rows", 3}, {"spacing_m", 256}}}}}},
                                     {"camera_path", nlohmann::json::parse(flight(offset_m, -offset_m))}}
                          .dump());
        const std::string out = folder_ + "/world " + std::to_string(int(offset_m));
        populate(mosaic, out);
        const Played played = play(out, {"--wait-for-tiles"});
        EXPECT_EQ(played.hashes().size(), size_t(k_frames));
        EXPECT_EQ(played.value("plants"), 9 * 6000.0);
        if (at_origin.empty())
            at_origin = played.hashes();
        else
            EXPECT_EQ(played.hashes(), at_origin) << "bit for bit";
    }
}

}  // namespace
