// One hash of all that a scene becomes, whoever compiled us and however many threads there are: the bytes of its populated
// folder, which hold cooked plants, tiles and clouds; the world that is read from them; what a frame of it counts; its picture.
#include <filesystem>
#include <fstream>
#include <map>
#include <unistd.h>
#include "plugins/modeller/grow.h"
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/stability/drawn_scene.h"
#include "tools/coppice/populate_pieces.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
constexpr ModellerInterface k_modeller{sizeof(ModellerInterface), modeller::grow_plant};

class Determinism : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("coppice_determinism_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        for (const char* species : {"daisy", "grass"})
            fs::copy_file(std::string(COPPICE_CONTENT_DIR) + "/species/" + species + ".json",
                          folder_ / (std::string(species) + ".json"));
        std::ofstream(folder_ / "meadow.eco.json") << R"({"name": "meadow",
            "plants": {"daisy": {"source": "daisy.json", "variations": 2}, "grass": {"source": "grass.json"}},
            "terrain": {"procedural": {"size_m": 64, "cell_m": 1, "seed": 3, "wavelength_m": 40, "octaves": 3, "amplitude_m": 6}},
            "placements": [
                {"scatter": {"plant": "daisy", "count": 3000, "scale": [2, 4], "region": {"circle": {"center": [0, 0], "radius_m": 30}}}},
                {"scatter": {"plant": "grass", "count": 5000, "scale": [0.7, 1.5], "region": {"circle": {"center": [3, 0], "radius_m": 28}}}}],
            "sun": {"azimuth_deg": 100, "elevation_deg": 30}})";
    }
    void TearDown() override {
        set_thread_limit(0);
        fs::remove_all(folder_);
    }

    // As `coppice populate` does, piece by piece.
    Status populate(const std::string& out) const {
        PopulateSettings settings;
        settings.scene = (folder_ / "meadow.eco.json").string();
        settings.folder = (folder_ / out).string();
        settings.cache_dir = (folder_ / "cache").string();
        settings.pack_plants = 3000;
        settings.terrain = &k_terrain;
        settings.modeller = &k_modeller;
        COPPICE_TRY(const Pieces pieces, list_pieces(settings));
        for (const PlantPiece& plant : pieces.plants) COPPICE_CHECK(make_plant(pieces, plant));
        COPPICE_TRY(const std::vector<Plant> plants, load_plants(pieces));
        for (const PackPiece& pack : pieces.packs) COPPICE_CHECK(make_pack(pieces, pack, plants));
        COPPICE_CHECK(make_scene(pieces, plants));
        return {};
    }

    // Names and bytes of all files, in the order of their names.
    uint64_t hash_of_folder(const std::string& out) const {
        std::map<std::string, fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / out))
            if (entry.is_regular_file())
                files[entry.path().lexically_relative(folder_ / out).generic_string()] = entry.path();
        uint64_t hash = files.size();
        for (const auto& [name, path] : files) {
            auto text = read_text_file(path.string());
            EXPECT_TRUE(text) << name;
            if (text) hash = hash_combine(hash_combine(hash, hash_text(name)), hash_text(*text));
        }
        return hash;
    }

    Result<TileForest> forest_of(const std::string& out) const {
        return load_forest((folder_ / out / "scene.json").string(), &k_terrain);
    }

    fs::path folder_;
};

uint64_t hash_of(const TileForest& forest) {
    uint64_t hash = forest.rows.size();
    auto mix = [&](auto value) { hash = hash_combine(hash, hash_bytes(&value, sizeof value)); };
    for (const ForestRow& row : forest.rows) {
        mix(row.origin);
        mix(row.bounds_tile.min);
        mix(row.bounds_tile.max);
        for (uint32_t number :
             {row.first_child, row.child_count, row.target, row.pack, row.node, row.cloud, row.ground})
            mix(number);
        mix(row.finest_density);
        mix(row.plant_count);
        mix(row.triangle_count);
    }
    for (const TileCloud& cloud : forest.clouds) {
        hash =
            hash_combine(hash, hash_bytes(cloud.points.data(), cloud.points.size() * sizeof(PackedVertex)));
        hash = hash_combine(hash, hash_bytes(cloud.densities.data(), cloud.densities.size() * sizeof(float)));
    }
    for (const ForestGround& ground : forest.grounds)
        if (ground.terrain) {
            const auto vertices = ground.terrain->vertices();
            hash = hash_combine(hash, hash_bytes(vertices.data(), vertices.size_bytes()));
        }
    return hash;
}

// Made with gcc 12 -O3; clang, every level of optimisation and any number of threads must give them too.
TEST_F(Determinism, EveryCompilerAndThreadCountGivesTheSameFolderAndWorld) {
    for (unsigned threads : {1u, 2u}) {
        SCOPED_TRACE(threads);
        set_thread_limit(threads);
        const std::string out = std::to_string(threads);
        const Status status = populate(out);
        ASSERT_TRUE(status) << to_string(status.error());
        EXPECT_EQ(hash_to_hex(hash_of_folder(out)), "e8a980f63ee18dc6");
        auto forest = forest_of(out);
        ASSERT_TRUE(forest) << to_string(forest.error());
        EXPECT_EQ(hash_to_hex(hash_of(*forest)), "600698042dc1bcfb");
    }
}

// What the device's own compiler makes of the kernels is another matter: of another driver the picture may differ.
TEST_F(Determinism, EveryCompilerAndThreadCountGivesTheSamePicture) {
    const Status status = populate("out");
    ASSERT_TRUE(status) << to_string(status.error());
    auto drawn = DrawnScene::create(320, 200);
    ASSERT_TRUE(drawn) << to_string(drawn.error());
    const std::string driver = (*drawn)->device().name + ", " + (*drawn)->device().driver;
    uint64_t counts = 0, words = 0, colors = 0;
    for (unsigned threads : {1u, 2u}) {
        set_thread_limit(threads);
        auto forest = forest_of("out");
        ASSERT_TRUE(forest) << to_string(forest.error());
        auto plants = load_plants(*forest);
        ASSERT_TRUE(plants) << to_string(plants.error());
        ASSERT_TRUE((*drawn)->vegetation().set_world(std::move(*forest), std::move(*plants), {}));
        uint64_t new_counts = 0, new_words = 0, new_colors = 0;
        for (ShadowKind kind : {ShadowKind::none, ShadowKind::uniform, ShadowKind::perspective,
                                ShadowKind::light_space, ShadowKind::clipmap})
            for (float sample_px : {0.5f, 1.0f, 4.0f}) {
                FrameSettings settings;
                settings.shadows = kind;
                settings.sample_distance_px = sample_px;
                settings.wait_for_tiles = true;
                Camera camera;
                camera.position_world = dvec3(0.3, 6.5, 24.0);
                camera.pitch_rad = -0.25f;
                ASSERT_TRUE((*drawn)->draw(camera, settings));
                const FrameReport& report = (*drawn)->report();
                for (uint64_t number :
                     {report.triangles, report.lines, report.points, report.leaves, report.terrain_triangles,
                      uint64_t(report.plants_visible), uint64_t(report.clouds), report.shadow_triangles,
                      report.shadow_points, report.work_entries})
                    new_counts = hash_combine(new_counts, number);
                new_words = hash_combine(new_words, hash_span(std::span<const uint64_t>((*drawn)->words)));
                new_colors = hash_combine(new_colors, hash_span(std::span<const uint32_t>((*drawn)->colors)));
                EXPECT_GT((*drawn)->count().covered_share(), 0.5);
                EXPECT_GT(report.points, 0u);
                if (sample_px < 1.0f) {
                    EXPECT_GT(report.triangles, 0u);
                    EXPECT_GT(report.lines, 0u);
                }
            }
        if (threads == 2) {
            EXPECT_EQ(new_counts, counts);
            EXPECT_EQ(new_words, words);
            EXPECT_EQ(new_colors, colors);
        }
        counts = new_counts;
        words = new_words;
        colors = new_colors;
    }
    EXPECT_EQ((*drawn)->validation_messages(), 0u);
    EXPECT_EQ(hash_to_hex(counts), "bd6444c81794b639");
    const std::string known = "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6 (LLVM 15.0.6)";
    if (driver != known) GTEST_SKIP() << "the picture's hash is known of " << known << ", this is " << driver;
    EXPECT_EQ(hash_to_hex(words), "e3271296204ce123");
    EXPECT_EQ(hash_to_hex(colors), "9829682301a5604e");
}

}  // namespace
}  // namespace coppice
