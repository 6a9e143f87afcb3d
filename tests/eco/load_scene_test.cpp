#include "plugins/vegetation/eco/load_scene.h"

#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

constexpr const char* k_scene = R"({
  "name": "small",
  "plants": {"oak": {"source": "../species/oak.json", "variations": 3, "importance": 2, "height_m": 14},
             "fern": {"source": "fern.glb"}},
  "regions": {"path": {"corridor": {"points": [[-60, 0], [60, 5]], "width_m": 4}}},
  "terrain": {"procedural": {"size_m": 128, "cell_m": 2, "amplitude_m": 4}},
  "placements": [
    {"plant": "oak", "at": [3, 1, 4], "turn_deg": 90, "scale": 1.5, "variation": 2},
    {"plant": "fern", "at": [10, -20], "tilt_deg": 10},
    {"scatter": {"plants": {"oak": 1, "fern": 9}, "density_per_m2": 0.2, "exclude": "path", "tilt_deg": 3,
                 "density_noise": {"wavelength_m": 20, "from": 0.4}, "scale": [0.8, 1.2]}},
    {"scatter": {"plant": "fern", "count": 100, "region": {"circle": {"center": [0, 0], "radius_m": 20}},
                 "spacing_m": 0.5, "slope_max_deg": 40, "altitude_m": [-50, 50]}}
  ],
  "sun": {"azimuth_deg": 90, "elevation_deg": 30, "color": [1, 2, 3]},
  "sky": {"zenith": [0, 0, 1]},
  "haze": {"density_per_m": 0.01},
  "camera_path": [{"time_s": 0, "at": [0, 0], "above_m": 2}],
  "sample_distance_px": 1.5
})";

std::string with(const char* old_text, const char* new_text) {
    std::string text = k_scene;
    size_t at = text.find(old_text);
    EXPECT_NE(at, std::string::npos) << old_text;
    return text.replace(at, std::string_view(old_text).size(), new_text);
}

TEST(LoadScene, ReadsEverything) {
    auto scene = load_scene_text(k_scene);
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(scene->name, "small");
    ASSERT_EQ(scene->models.size(), 4u);  // by name: fern, then three oaks
    EXPECT_EQ(scene->models[0].name, "fern");
    EXPECT_EQ(scene->models[3].variation, 2u);
    EXPECT_EQ(scene->models[3].importance, 2.0f);
    EXPECT_TRUE(scene->models[3].source_path.ends_with("/species/oak.json"));
    EXPECT_EQ(scene->models[3].source_path.find(".."), std::string::npos);
    EXPECT_NEAR(scene->light.direction_to_sun.x, portable_cos(k_pi / 6), 1e-5f);
    EXPECT_NEAR(scene->light.direction_to_sun.y, 0.5f, 1e-5f);
    EXPECT_EQ(scene->light.sun_color, vec3(1, 2, 3));
    EXPECT_EQ(scene->light.haze_density_per_m, 0.01f);
    EXPECT_EQ(scene->sample_distance_px, 1.5f);
    ASSERT_EQ(scene->camera_path.size(), 1u);
    EXPECT_NEAR(scene->camera_path[0].camera.position_world.y, double(scene->terrain->height_at(0, 0)) + 2.0,
                1e-6);
    EXPECT_GT(scene->positions.size(), 1000u);
    EXPECT_LT(scene->positions.size(), 3400u);

    size_t on_path = 0, first_oak = 0, in_air = 0;
    for (const SceneTile& tile : scene->tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = scene->positions[row];
            dvec3 at = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
            bool written = std::abs(at.x - 3) < 1e-4 && std::abs(at.z - 4) < 1e-4;
            if (written) {
                ++first_oak;
                EXPECT_NEAR(at.y, 1.0, 1e-4);
                EXPECT_EQ(p.scale, 1.5f);
                EXPECT_EQ(scene->plant_models[row].model, 3u);
            } else {
                in_air += std::abs(at.y - double(scene->terrain->height_at(float(at.x), float(at.z)))) > 0.01;
            }
            on_path += std::abs(at.z - 2.5 - at.x * 5.0 / 120.0) < 1.5 && std::abs(at.x) > 21.0 &&
                       std::abs(at.x) < 58.0;
        }
    EXPECT_EQ(first_oak, 1u);
    EXPECT_EQ(in_air, 0u);
    EXPECT_EQ(on_path, 0u);
}

TEST(LoadScene, SameOnAnyNumberOfThreads) {
    auto hash = [] {
        auto scene = load_scene_text(k_scene);
        EXPECT_TRUE(scene);
        return hash_bytes(
            scene->positions.data(), scene->positions.size() * sizeof(PlantPosition),
            hash_bytes(scene->plant_models.data(), scene->plant_models.size() * sizeof(PlantModel)));
    };
    set_thread_limit(1);
    uint64_t one = hash();
    set_thread_limit(0);
    EXPECT_EQ(one, hash());
}

TEST(LoadScene, ReadsCsvWithAliases) {
    ScratchFile csv("trees.csv", "x,y,species,height\n500010,20,QURO,7\n500011,21,fern,\n");
    auto scene = load_scene_text(with("{\"plant\": \"fern\", \"at\": [10, -20], \"tilt_deg\": 10}",
                                      "{\"csv\": \"trees.csv\", \"offset\": [-500000, 0], "
                                      "\"species\": {\"QURO\": \"oak\"}}"));
    ASSERT_TRUE(scene) << to_string(scene.error());
    size_t found = 0;
    for (const SceneTile& tile : scene->tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = scene->positions[row];
            dvec3 at = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
            if (std::abs(at.x - 10) > 1e-4 || std::abs(at.z - 20) > 1e-4) continue;
            ++found;
            EXPECT_EQ(p.scale, 0.5f);
        }
    EXPECT_EQ(found, 1u);
}

TEST(LoadScene, NeedsNothingButPlantsAndPlacements) {
    auto scene = load_scene_text(R"({"plants": {"oak": {"source": "oak.json"}}, "placements": []})",
                                 "meadow.eco.json");
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(scene->name, "meadow");
    EXPECT_EQ(scene->camera_path.size(), 1u);
    EXPECT_TRUE(scene->tiles.empty());
    EXPECT_EQ(scene->terrain, nullptr);
    EXPECT_EQ(
        glm::length(load_scene_text(
                        with("{\"azimuth_deg\": 90, \"elevation_deg\": 30, \"color\": [1, 2, 3]}", "null"))
                        ->light.direction_to_sun),
        0.0f);
}

TEST(LoadScene, EveryFaultOnce) {
    struct Case {
        const char* was;
        const char* is;
        ErrorId id;
        const char* place;
    };
    for (const Case& bad : std::initializer_list<Case>{
             {"\"name\": \"small\",", "\"name\": \"small\"", ErrorId::syntax, "line 3, column 10"},
             {"\"name\":", "\"nmae\":", ErrorId::name_unknown, ""},
             {"\"plants\": {\"oak\"", "\"plans\": {\"oak\"", ErrorId::syntax, "plants"},
             {"\"variations\": 3", "\"variations\": 0", ErrorId::value_out_of_range, "plants.oak.variations"},
             {"\"variations\": 3", "\"variations\": 1e9", ErrorId::value_out_of_range,
              "plants.oak.variations"},
             {"\"source\": \"fern.glb\"", "\"source\": \"fern.glb\", \"variations\": 2",
              ErrorId::value_out_of_range, "plants.fern.variations"},
             {"\"importance\": 2", "\"importance\": -2", ErrorId::value_out_of_range,
              "plants.oak.importance"},
             {"\"importance\": 2", "\"importence\": 2", ErrorId::name_unknown, "plants.oak"},
             {"\"width_m\": 4", "\"width_m\": 0", ErrorId::value_out_of_range,
              "regions.path.corridor.width_m"},
             {"{\"plant\": \"oak\"", "{\"plant\": \"oka\"", ErrorId::name_unknown, "placements[0].plant"},
             {"{\"plant\": \"oak\"", "{\"plnt\": \"oak\"", ErrorId::syntax, "placements[0]"},
             {"[3, 1, 4]", "[3]", ErrorId::value_out_of_range, "placements[0].at"},
             {"[3, 1, 4]", "[3, 1, 1e40]", ErrorId::value_out_of_range, "placements[0].at"},
             {"\"scale\": 1.5", "\"scale\": 0", ErrorId::value_out_of_range, "placements[0].scale"},
             {"\"variation\": 2", "\"variation\": 3", ErrorId::value_out_of_range, "placements[0].variation"},
             {"\"tilt_deg\": 10", "\"tlit_deg\": 10", ErrorId::name_unknown, "placements[1]"},
             {"\"fern\": 9", "\"fren\": 9", ErrorId::name_unknown, "placements[2].scatter.plants.fren"},
             {"\"fern\": 9", "\"fern\": -9", ErrorId::value_out_of_range,
              "placements[2].scatter.plants.fern"},
             {"\"exclude\": \"path\"", "\"exclude\": \"pth\"", ErrorId::name_unknown,
              "placements[2].scatter.exclude"},
             {"\"density_per_m2\": 0.2", "\"density_per_m2\": 99999", ErrorId::limit_exceeded,
              "placements[2].scatter"},
             {"\"density_per_m2\": 0.2", "\"density_per_m2\": 0", ErrorId::value_out_of_range,
              "placements[2].scatter.density_per_m2"},
             {"\"density_per_m2\": 0.2,", "", ErrorId::syntax, "placements[2].scatter"},
             {"[0.8, 1.2]", "[1.2, 0.8]", ErrorId::value_out_of_range, "placements[2].scatter.scale"},
             {"\"scale\": [0.8, 1.2]", "\"height_m\": [1, 2]", ErrorId::value_out_of_range,
              "placements[2].scatter.height_m"},
             {"\"from\": 0.4", "\"threshold\": 0.4", ErrorId::name_unknown,
              "placements[2].scatter.density_noise"},
             {"\"count\": 100", "\"count\": 100000000", ErrorId::value_out_of_range,
              "placements[3].scatter.count"},
             {"\"count\": 100", "\"count\": 19999999", ErrorId::value_out_of_range,
              "placements[3].scatter.count"},
             {"\"elevation_deg\": 30", "\"elevation_deg\": \"high\"", ErrorId::value_out_of_range,
              "sun.elevation_deg"},
             {"\"amplitude_m\": 4", "\"amplitude\": 4", ErrorId::name_unknown, "terrain.procedural"},
             {"[{\"time_s\": 0, \"at\": [0, 0], \"above_m\": 2}]", "\"nowhere.json\"", ErrorId::file_missing,
              ""},
             {"\"sample_distance_px\": 1.5", "\"sample_distance_px\": 0", ErrorId::value_out_of_range,
              "sample_distance_px"},
             {"{\"plant\": \"fern\", \"at\": [10, -20], \"tilt_deg\": 10}", "{\"csv\": \"nowhere.csv\"}",
              ErrorId::file_missing, ""},
         }) {
        auto scene = load_scene_text(with(bad.was, bad.is));
        ASSERT_FALSE(scene) << bad.is;
        EXPECT_EQ(scene.error().id, bad.id) << bad.is << ": " << to_string(scene.error());
        EXPECT_EQ(scene.error().place, bad.place) << bad.is << ": " << to_string(scene.error());
        EXPECT_FALSE(scene.error().file.empty());
        EXPECT_FALSE(scene.error().remedy.empty());
    }
    EXPECT_EQ(load_scene("nowhere.eco.json", {}).error().id, ErrorId::file_missing);
    ScratchFile file("scene.eco.json", k_scene);
    EXPECT_EQ(load_scene(file.path(), {}).error().place, "terrain");
}

// Whatever is cut off or overwritten, there is an answer and no crash.
TEST(LoadScene, SurvivesBrokenText) {
    std::string text = k_scene;
    for (size_t cut = 0; cut < text.size(); cut += 7) EXPECT_FALSE(load_scene_text(text.substr(0, cut)));
    size_t read = 0;
    for (size_t at = 0; at < text.size(); at += 11) {
        std::string broken = text;
        broken[at] = char('0' + at % 10);
        read += load_scene_text(broken).has_value();
    }
    EXPECT_GT(read, 0u);  // a changed digit is still a scene
}

}  // namespace
}  // namespace coppice
