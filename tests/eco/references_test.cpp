// Scenes in scenes: where the plants of referenced files come to stand, and which references are refused.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <fmt/format.h>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

using Files = std::vector<std::pair<std::string, std::string>>;

// The first file is the root; the others lie beside it.
Result<Scene> load(const Files& files) {
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    std::vector<std::unique_ptr<ScratchFile>> scratch;
    for (const auto& [name, text] : files) scratch.push_back(std::make_unique<ScratchFile>(name, text));
    return load_scene(scratch.front()->path(), {&k_terrain});
}

Scene loaded(const Files& files) {
    auto scene = load(files);
    EXPECT_TRUE(scene) << (scene ? "" : to_string(scene.error()));
    return scene ? std::move(*scene) : Scene{};
}

struct Stood {
    dvec3 at;
    float scale;
    vec3 east, up;  // of the plant
    PlantModel model;
};

// From west to east, then from north to south.
std::vector<Stood> plants_of(const Scene& scene) {
    std::vector<Stood> plants;
    for (const SceneTile& tile : scene.tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = scene.positions[row];
            mat3 turn = rotation_matrix(scene.turns[row]);
            plants.push_back({tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile), p.scale, turn[0],
                              turn[1], scene.plant_models[row]});
        }
    std::sort(plants.begin(), plants.end(), [](const Stood& a, const Stood& b) {
        auto rounded = [](double x) { return std::floor(x * 64.0 + 0.5); };
        double ax = rounded(a.at.x), bx = rounded(b.at.x);
        return ax != bx ? ax < bx : a.at.z < b.at.z;
    });
    return plants;
}

void expect_near(vec3 found, vec3 wanted, float bound) {
    EXPECT_LT(glm::length(found - wanted), bound) << fmt::format(
        "({}, {}, {}) for ({}, {}, {})", found.x, found.y, found.z, wanted.x, wanted.y, wanted.z);
}

const char* k_oak = R"({"plants": {"oak": {"source": "oak.json"}},
                        "placements": [{"plant": "oak", "at": [10, 0], "turn_deg": 0, "scale": 2}]})";

std::string referring(const std::string& references, const std::string& more = "") {
    return "{" + more + "\"references\": " + references + "}";
}

std::string hills() {
    return R"("terrain": {"procedural": {"size_m": 400, "cell_m": 2, "amplitude_m": 30}}, )";
}

uint64_t hash_of(const Scene& scene) {
    uint64_t hash = hash_bytes(scene.positions.data(), scene.positions.size() * sizeof(PlantPosition));
    hash = hash_bytes(scene.turns.data(), scene.turns.size() * sizeof(PlantTurn), hash);
    return hash_bytes(scene.plant_models.data(), scene.plant_models.size() * sizeof(PlantModel), hash);
}

TEST(References, TurnScaleAndMove) {
    Scene scene = loaded({{"root.eco.json", referring(R"([{"scene": "a.eco.json", "at": [100, 50],
                                                           "turn_deg": 90, "scale": 3}])")},
                          {"a.eco.json", k_oak}});
    auto plants = plants_of(scene);
    ASSERT_EQ(plants.size(), 1u);
    // 10 m east, turned left and three times as far, is 30 m north.
    expect_near(plants[0].at, vec3(100, 0, 20), 1e-4f);
    EXPECT_EQ(plants[0].scale, 6.0f);
    expect_near(plants[0].east, vec3(0, 0, -1), 1e-4f);
    ASSERT_EQ(scene.models.size(), 1u);
    EXPECT_TRUE(scene.models[0].source_path.ends_with("/oak.json"));
}

TEST(References, NestAndNameEachModelOnce) {
    const char* grove = R"({"plants": {"tree": {"source": "oak.json"}, "fern": {"source": "fern.glb"}},
        "placements": [{"plant": "fern", "at": [0, 5], "scale": 1}, {"plant": "tree", "at": [1, 5]}],
        "references": [{"scene": "../REST/a.eco.json", "at": [0, 10], "turn_deg": -90, "scale": 0.5}]})";
    std::string inner = grove;
    ScratchFile root("root.eco.json", R"({"plants": {"oak": {"source": "oak.json"}},
        "placements": [{"plant": "oak", "at": [0, 0]}],
        "references": [{"scene": "grove.eco.json", "at": [100, 0], "turn_deg": 180, "scale": 2},
                       {"scene": "a.eco.json", "at": [500, 0]}]})");
    std::string folder = std::filesystem::path(root.path()).parent_path().filename().string();
    inner.replace(inner.find("REST"), 4, folder);
    ScratchFile grove_file("grove.eco.json", inner), oak_file("a.eco.json", k_oak);
    auto scene = load_scene(root.path(), {});
    ASSERT_TRUE(scene) << to_string(scene.error());
    // The oak has one name in three files, and one model; a.eco.json is one file by two ways.
    ASSERT_EQ(scene->models.size(), 2u);
    EXPECT_EQ(scene->models[0].name, "oak");
    EXPECT_EQ(scene->models[1].name, "fern");
    auto plants = plants_of(*scene);
    ASSERT_EQ(plants.size(), 5u);
    expect_near(plants[0].at, vec3(0), 1e-4f);
    expect_near(plants[1].at, vec3(98, 0, -10), 1e-4f);
    // 10 m east of its file's origin, 5 m south after the inner reference, beside its 10 m; twice as far, turned round.
    expect_near(plants[2].at, vec3(100, 0, -30), 1e-4f);
    EXPECT_EQ(plants[2].scale, 2.0f);
    expect_near(plants[2].east, vec3(0, 0, -1), 1e-4f);
    expect_near(plants[3].at, vec3(100, 0, -10), 1e-4f);
    EXPECT_EQ(plants[3].model.model, 1u);
    expect_near(plants[4].at, vec3(510, 0, 0), 1e-4f);
}

TEST(References, GridsLieAboutTheirPlaceAndTurnStepByStep) {
    Scene scene = loaded({{"root.eco.json", referring(R"([{"scene": "a.eco.json", "at": [1000, 200], "grid":
                              {"columns": 3, "rows": 2, "spacing_m": 100, "turn_step_deg": 90}}])")},
                          {"a.eco.json", k_oak}});
    auto plants = plants_of(scene);
    ASSERT_EQ(plants.size(), 6u);
    // Copies by rows: turned by 0, 90, 180 in the north, 270, 0, 90 in the south, each 10 m from its middle.
    const std::vector<vec3> wanted{{900, 0, 260},  {910, 0, 150},  {1000, 0, 140},
                                   {1010, 0, 250}, {1090, 0, 150}, {1100, 0, 240}};
    for (size_t i = 0; i < wanted.size(); ++i) expect_near(plants[i].at, wanted[i], 1e-3f);
    // The whole grid turns with its reference.
    auto turned =
        plants_of(loaded({{"root.eco.json", referring(R"([{"scene": "a.eco.json", "turn_deg": 90, "grid":
                                        {"columns": 3, "rows": 1, "spacing_m": 100}}])")},
                          {"a.eco.json", k_oak}}));
    ASSERT_EQ(turned.size(), 3u);
    for (int i = 0; i < 3; ++i) expect_near(turned[size_t(i)].at, vec3(0, 0, -110 + 100 * i), 1e-3f);
}

TEST(References, CopiesHaveSeedsOfTheirOwn) {
    Scene scene = loaded({{"root.eco.json", referring(R"([{"scene": "a.eco.json", "grid":
                              {"columns": 40, "rows": 40, "spacing_m": 10}}, {"scene": "a.eco.json"}])")},
                          {"a.eco.json", k_oak}});
    std::vector<uint32_t> seeds;
    double mean = 0.0;
    for (const PlantModel& plant : scene.plant_models) {
        seeds.push_back(plant.seed);
        mean += double(plant.seed) / 4294967296.0 / double(scene.plant_models.size());
    }
    std::sort(seeds.begin(), seeds.end());
    EXPECT_EQ(std::unique(seeds.begin(), seeds.end()) - seeds.begin(), 1601);
    EXPECT_NEAR(mean, 0.5, 0.03);
}

TEST(References, PlantsStandOnTheRootsGround) {
    const char* grove = R"({"plants": {"fern": {"source": "fern.glb"}},
        "terrain": {"flat": {"size_m": 100, "height_m": 77}}, "sun": null, "camera_path": "nowhere.json",
        "placements": [{"plant": "fern", "at": [8, 0]}, {"plant": "fern", "at": [-8, 2, 0]},
                       {"scatter": {"plant": "fern", "count": 200, "region": {"circle": {"center": [0, 0], "radius_m": 30}}}}],
        "references": [{"scene": "a.eco.json", "at": [0, 8]}]})";
    std::string notes;
    set_log_sink(
        [](void* context, LogLevel, std::string_view line) { *static_cast<std::string*>(context) += line; },
        &notes);
    Scene scene =
        loaded({{"root.eco.json",
                 referring(R"([{"scene": "grove.eco.json", "at": [60, -40], "scale": 1.5}])", hills())},
                {"grove.eco.json", grove},
                {"a.eco.json", k_oak}});
    set_log_sink(nullptr, nullptr);
    EXPECT_NE(notes.find("grove.eco.json: terrain, sun, camera_path left out"), std::string::npos) << notes;
    EXPECT_GT(glm::length(scene.light.direction_to_sun), 0.0f);
    size_t above = 0;
    auto plants = plants_of(scene);
    ASSERT_EQ(plants.size(), 203u);
    double lowest = INFINITY, highest = -INFINITY;
    for (const Stood& plant : plants) {
        double ground = double(scene.terrain->height_at(float(plant.at.x), float(plant.at.z)));
        lowest = std::min(lowest, ground);
        highest = std::max(highest, ground);
        if (std::abs(plant.at.y - ground) < 1e-3) continue;
        EXPECT_NEAR(plant.at.y, ground + 3.0, 1e-3);
        ++above;
    }
    EXPECT_EQ(above, 1u);
    EXPECT_GT(highest - lowest, 2.0) << "the ground is flat: nothing was tested";
}

TEST(References, AHeightOfItsOwnHoldsForAllOfAReference) {
    Scene scene =
        loaded({{"root.eco.json",
                 referring(R"([{"scene": "b.eco.json", "at": [60, 500, -40], "scale": 2}])", hills())},
                {"b.eco.json", referring(R"([{"scene": "a.eco.json", "at": [50, 0]},
                                                       {"scene": "a.eco.json", "at": [80, 7, 0]}])")},
                {"a.eco.json", k_oak}});
    auto plants = plants_of(scene);
    ASSERT_EQ(plants.size(), 2u);
    EXPECT_NEAR(plants[0].at.y, 500.0, 1e-4);
    EXPECT_NEAR(plants[1].at.y, 514.0, 1e-4);
}

// What a scatter asks of the ground is asked of the ground its plants come to stand on.
TEST(References, RulesOfTheGroundHoldWherePlantsComeToStand) {
    const char* grove = R"({"plants": {"fern": {"source": "fern.glb"}}, "placements": [
        {"scatter": {"plant": "fern", "density_per_m2": 1, "region": {"rectangle": {"center": [0, 0], "size_m": [80, 80]}},
                     "slope_max_deg": 14, "altitude_m": [-5, 40], "align_to_ground": 1}}]})";
    Scene scene = loaded({{"root.eco.json", referring(R"([{"scene": "grove.eco.json", "grid":
                              {"columns": 4, "rows": 4, "spacing_m": 80, "turn_step_deg": 37}}])",
                                                      hills())},
                          {"grove.eco.json", grove}});
    size_t whole = loaded({{"root.eco.json", grove}}).positions.size() * 16;
    EXPECT_GT(scene.positions.size(), whole / 20);
    EXPECT_LT(scene.positions.size(), whole * 3 / 4);
    float least_up = portable_cos(14.0f * k_pi / 180.0f);
    for (const Stood& plant : plants_of(scene)) {
        vec3 normal = scene.terrain->normal_at(float(plant.at.x), float(plant.at.z));
        ASSERT_GT(normal.y, least_up - 1e-4f);
        ASSERT_GT(plant.at.y, -5.001);
        ASSERT_LT(plant.at.y, 40.001);
        ASSERT_GT(glm::dot(plant.up, normal), 0.9999f) << "stands at right angles to the slope";
    }
}

TEST(References, SameBytesOnAnyNumberOfThreadsAndARootIsAsItWas) {
    const char* grove = R"({"plants": {"fern": {"source": "fern.glb", "variations": 1}}, "placements": [
        {"scatter": {"plant": "fern", "density_per_m2": 0.8, "region": {"circle": {"center": [0, 0], "radius_m": 60}},
                     "slope_max_deg": 14, "align_to_ground": 0.5, "tilt_deg": 8}}]})";
    Files files{{"root.eco.json", referring(R"([{"scene": "grove.eco.json", "grid": {"columns": 5, "rows": 3,
                     "spacing_m": 60, "turn_step_deg": 77}}, {"scene": "a.eco.json", "turn_deg": 12.5, "grid":
                     {"columns": 100, "rows": 70, "spacing_m": 3}}])",
                                            hills())},
                {"grove.eco.json", grove},
                {"a.eco.json", k_oak}};
    set_thread_limit(1);
    Scene one = loaded(files);
    set_thread_limit(0);
    Scene many = loaded(files);
    EXPECT_GT(one.positions.size(), 20000u);
    EXPECT_EQ(hash_of(one), hash_of(many));

    // References change nothing about the plants that were there.
    std::string alone = grove, with = grove;
    with.insert(with.size() - 1, R"(, "references": [{"scene": "a.eco.json", "at": [5000, 0]}])");
    Scene before = loaded({{"root.eco.json", alone}}),
          after = loaded({{"root.eco.json", with}, {"a.eco.json", k_oak}});
    auto old_plants = plants_of(before), new_plants = plants_of(after);
    ASSERT_EQ(new_plants.size(), old_plants.size() + 1);
    for (size_t i = 0; i < old_plants.size(); ++i) {
        ASSERT_LT(glm::length(new_plants[i].at - old_plants[i].at), 1e-3);
        ASSERT_EQ(new_plants[i].model.seed, old_plants[i].model.seed);
    }
}

TEST(References, ACycleIsShown) {
    auto itself = load({{"a.eco.json", referring(R"([{"scene": "a.eco.json"}])")}});
    ASSERT_FALSE(itself);
    EXPECT_EQ(itself.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(itself.error().place, "references[0].scene");

    auto cycle = load({{"root.eco.json", referring(R"([{"scene": "a.eco.json"}])")},
                       {"a.eco.json", referring(R"([{"scene": "leaf.eco.json"}, {"scene": "b.eco.json"}])")},
                       {"b.eco.json", referring(R"([{"scene": "./a.eco.json"}])")},
                       {"leaf.eco.json", k_oak}});
    ASSERT_FALSE(cycle);
    EXPECT_EQ(cycle.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(cycle.error().place, "references[0].scene");
    EXPECT_TRUE(cycle.error().file.ends_with("b.eco.json")) << cycle.error().file;
    const std::string& fault = cycle.error().fault;
    size_t first = fault.find("a.eco.json -> "), second = fault.find("b.eco.json -> "),
           last = fault.rfind("a.eco.json");
    EXPECT_TRUE(first < second && second < last && last != first && last != std::string::npos) << fault;
    EXPECT_EQ(fault.find("root.eco.json"), std::string::npos) << "not part of the way round: " << fault;
}

TEST(References, SixteenDeepAreRead) {
    auto chain = [](int length) {
        Files files;
        for (int i = 0; i < length; ++i)
            files.emplace_back(
                fmt::format("s{}.eco.json", i),
                referring(fmt::format(R"([{{"scene": "s{}.eco.json", "at": [1, 0]}}])", i + 1)));
        files.emplace_back(fmt::format("s{}.eco.json", length), k_oak);
        return files;
    };
    auto plants = plants_of(loaded(chain(16)));
    ASSERT_EQ(plants.size(), 1u);
    EXPECT_NEAR(plants[0].at.x, 26.0, 1e-4);
    auto deeper = load(chain(17));
    ASSERT_FALSE(deeper);
    EXPECT_EQ(deeper.error().id, ErrorId::limit_exceeded);
    EXPECT_EQ(deeper.error().place, "references[0].scene");
    EXPECT_TRUE(deeper.error().file.ends_with("s16.eco.json")) << deeper.error().file;

    // Also by a way that joins a chain read before.
    Files files = chain(16);
    files[0].second = referring(R"([{"scene": "s1.eco.json"}, {"scene": "x.eco.json"}])");
    files.emplace_back("x.eco.json", referring(R"([{"scene": "s1.eco.json"}])"));
    auto joined = load(files);
    ASSERT_FALSE(joined);
    EXPECT_EQ(joined.error().id, ErrorId::limit_exceeded);
    EXPECT_TRUE(joined.error().file.ends_with("x.eco.json")) << to_string(joined.error());
}

TEST(References, TooManyPlantsAreRefusedBeforeTheyAreMade) {
    // 10^3 of 10^3 of ... : counted, not made.
    Files files{{"s0.eco.json", ""}, {"s1.eco.json", ""}, {"s2.eco.json", ""}, {"s3.eco.json", k_oak}};
    for (size_t i = 0; i < 3; ++i)
        files[i].second = referring(fmt::format(
            R"([{{"scene": "s{}.eco.json", "grid": {{"columns": 1000, "rows": 1, "spacing_m": 1}}}}])",
            i + 1));
    auto scene = load(files);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().id, ErrorId::limit_exceeded);
    EXPECT_EQ(scene.error().place, "references[0]");
    EXPECT_TRUE(scene.error().file.ends_with("s0.eco.json")) << scene.error().file;
    EXPECT_NE(scene.error().fault.find("1000000000"), std::string::npos) << scene.error().fault;
    files.erase(files.begin());
    EXPECT_EQ(loaded(files).positions.size(), 1000000u);

    // However many times nothing stands there, it costs nothing.
    files[2].second = R"({"plants": {}, "placements": []})";
    files[0].second =
        referring(R"([{"scene": "s3.eco.json", "grid": {"columns": 20000000, "rows": 1, "spacing_m": 1}}])");
    EXPECT_EQ(loaded(files).positions.size(), 0u);
}

TEST(References, EveryFaultHasItsPlace) {
    struct Case {
        const char* entry;
        ErrorId id;
        const char* place;
    };
    for (
        const Case& bad : std::initializer_list<Case>{
            {R"({"scene": "nowhere.eco.json"})", ErrorId::file_missing, "references[1].scene"},
            {R"({"scene": ""})", ErrorId::syntax, "references[1].scene"},
            {R"({"at": [0, 0]})", ErrorId::syntax, "references[1].scene"},
            {R"("a.eco.json")", ErrorId::syntax, "references[1]"},
            {R"({"scene": "a.eco.json", "turn": 3})", ErrorId::name_unknown, "references[1]"},
            {R"({"scene": "a.eco.json", "at": [1]})", ErrorId::value_out_of_range, "references[1].at"},
            {R"({"scene": "a.eco.json", "at": [1, 2, 3, 4]})", ErrorId::value_out_of_range,
             "references[1].at"},
            {R"({"scene": "a.eco.json", "at": [1e8, 0]})", ErrorId::value_out_of_range, "references[1].at"},
            {R"({"scene": "a.eco.json", "at": [1, null, 0]})", ErrorId::value_out_of_range,
             "references[1].at"},
            {R"({"scene": "a.eco.json", "turn_deg": "90"})", ErrorId::value_out_of_range,
             "references[1].turn_deg"},
            {R"({"scene": "a.eco.json", "scale": 0})", ErrorId::value_out_of_range, "references[1].scale"},
            {R"({"scene": "a.eco.json", "scale": -1})", ErrorId::value_out_of_range, "references[1].scale"},
            {R"({"scene": "a.eco.json", "scale": 1e30})", ErrorId::value_out_of_range, "references[1].scale"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 2, "spacing_m": 1}})", ErrorId::syntax,
             "references[1].grid.rows"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 2, "rows": 2}})", ErrorId::syntax,
             "references[1].grid.spacing_m"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 0, "rows": 2, "spacing_m": 1}})",
             ErrorId::value_out_of_range, "references[1].grid.columns"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 4294967296, "rows": 4294967296, "spacing_m": 1}})",
             ErrorId::value_out_of_range, "references[1].grid.columns"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 65536, "rows": 65536, "spacing_m": 1}})",
             ErrorId::limit_exceeded, "references[1].grid.columns"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 2, "rows": 2, "spacing_m": 1, "jitter": 1}})",
             ErrorId::name_unknown, "references[1].grid"},
            {R"({"scene": "a.eco.json", "grid": {"columns": 1000, "rows": 1, "spacing_m": 1e6}})",
             ErrorId::value_out_of_range, "references[1]"},
            {R"({"scene": "s.eco.json", "scale": 1000})", ErrorId::value_out_of_range, "references[1].scale"},
        }) {
        auto scene = load(
            {{"root.eco.json", referring(std::string("[{\"scene\": \"a.eco.json\"}, ") + bad.entry + "]")},
             {"a.eco.json", k_oak},
             {"s.eco.json", referring(R"([{"scene": "a.eco.json", "scale": 1000}])")}});
        ASSERT_FALSE(scene) << bad.entry;
        EXPECT_EQ(scene.error().id, bad.id) << bad.entry << ": " << to_string(scene.error());
        EXPECT_EQ(scene.error().place, bad.place) << bad.entry << ": " << to_string(scene.error());
        EXPECT_TRUE(scene.error().file.ends_with("root.eco.json")) << to_string(scene.error());
        EXPECT_FALSE(scene.error().remedy.empty());
    }
}

// A fault in a referenced file is that file's, and it is held to the same rules.
TEST(References, FaultsOfAReferencedFileNameIt) {
    auto fault = [](const char* text) {
        auto scene =
            load({{"root.eco.json", referring(R"([{"scene": "a.eco.json"}])")}, {"a.eco.json", text}});
        EXPECT_FALSE(scene) << text;
        EXPECT_TRUE(scene || scene.error().file.ends_with("a.eco.json")) << text;
        return scene ? Error{} : scene.error();
    };
    EXPECT_EQ(fault("{").id, ErrorId::syntax);
    EXPECT_EQ(fault(R"({"plants": {}, "placements": [], "snu": null})").id, ErrorId::name_unknown);
    EXPECT_EQ(fault(R"({"plants": {}})").place, "placements");
    EXPECT_EQ(fault(R"({"plants": {"x": {"source": "x.glb"}}, "placements": [
                        {"scatter": {"plant": "x", "density_per_m2": 1}}]})")
                  .place,
              "placements[0].scatter.region");
}

}  // namespace
}  // namespace coppice
