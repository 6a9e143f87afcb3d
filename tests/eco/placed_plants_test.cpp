#include "plugins/vegetation/eco/placed_plants.h"

#include <algorithm>
#include "runtime/core/hash.h"
#include "runtime/core/random.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

PlacedPlants some_plants(size_t count) {
    PlacedPlants placed{{"oak", "fern", "birch"}, {}};
    Random random(7);
    for (size_t i = 0; i < count; ++i) {
        const dvec3 at(double(random.next_in(-500, 500)), 0.0, double(random.next_in(-500, 500)));
        placed.plants.push_back(pack_placed(at, random.next_in(0.5f, 2.0f),
                                            pack_turn_about_y(random.next_in(0.0f, 6.28f)),
                                            uint16_t(random.next_below(3)), uint16_t(random.next_below(4))));
    }
    return placed;
}

// As (name, plant): kinds are numbered by the file.
std::vector<std::pair<std::string, PlacedPlant>> by_name(const PlacedPlants& placed) {
    std::vector<std::pair<std::string, PlacedPlant>> all;
    for (PlacedPlant plant : placed.plants) {
        const std::string& name = placed.kinds[plant.kind];
        plant.kind = 0;
        all.emplace_back(name, plant);
    }
    std::sort(all.begin(), all.end());
    return all;
}

TEST(PlacedPlants, KeepScalesAndTurns) {
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const float scale = portable_exp2(random.next_in(-9.9f, 9.9f));
        EXPECT_NEAR(unpack_scale(pack_scale(scale)) / scale, 1.0f, 2.6e-4f);
        const float turn_rad = random.next_in(0.0f, 2.0f * k_pi), lean_rad = random.next_in(0.0f, k_pi);
        const float bearing_rad = random.next_in(0.0f, 2.0f * k_pi);
        const PlantTurn turn =
            make_turn(turn_rad, lean_rad, vec3(portable_cos(bearing_rad), 0, portable_sin(bearing_rad)));
        const mat3 before = rotation_matrix(turn);
        const mat3 after = rotation_matrix(unpack_placed_turn(pack_placed_turn(turn)));
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_GT(glm::dot(glm::normalize(before[axis]), glm::normalize(after[axis])), 0.99999f)
                << "cosine of a quarter of a degree";
    }
    EXPECT_EQ(unpack_scale(pack_scale(1.0f)), 1.0f);
    EXPECT_EQ(pack_scale(0.0f), 0u);
    EXPECT_EQ(pack_scale(1e9f), 65535u);
    for (float turn_rad = 0.0f; turn_rad < 6.3f; turn_rad += 0.01f) {
        const PlantTurn upright = unpack_placed_turn(pack_placed_turn(pack_turn_about_y(turn_rad)));
        EXPECT_EQ(upright.x, 0);
        EXPECT_EQ(upright.z, 0);
    }
    const PlacedPlant far = pack_placed({1e12, -1e9, NAN}, 1.0f, {}, 0, 0);
    EXPECT_EQ(far.x, INT32_MAX);
    EXPECT_EQ(far.z, 0);
    EXPECT_EQ(far.lift, -32767);
}

TEST(PlacedPlants, AreTheSameBytesInAnyOrderAndUnder20BytesEach) {
    PlacedPlants placed = some_plants(1000);
    const std::string bytes = write_placed(placed);
    EXPECT_LT(bytes.size(), 1000u * 20);
    auto read = read_placed(bytes, "plants");
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_EQ(by_name(*read), by_name(placed));
    std::reverse(placed.plants.begin(), placed.plants.end());
    std::swap(placed.kinds[0], placed.kinds[2]);
    for (PlacedPlant& plant : placed.plants) plant.kind = uint16_t(2 - plant.kind);
    placed.kinds.push_back("unused");
    EXPECT_EQ(write_placed(placed), bytes);
}

TEST(PlacedPlants, AreRefusedCutOrChangedAnywhere) {
    const std::string bytes = write_placed(some_plants(20));
    for (size_t length = 0; length < bytes.size(); ++length)
        EXPECT_FALSE(read_placed(std::string_view(bytes).substr(0, length), "plants")) << length;
    for (size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        changed[at] = char(changed[at] ^ 0x41);
        EXPECT_FALSE(read_placed(changed, "plants")) << at;
    }
}

constexpr const char* k_scene = R"({
  "plants": {"birch": {"source": "b.json"}, "fern": {"source": "f.glb"},
             "oak": {"source": "o.json", "variations": 3}},
  "terrain": {"procedural": {"size_m": 1024, "cell_m": 8, "amplitude_m": 20}},
  "placements": [{"packed": "scene.plants"}]
})";

TEST(PlacedPlants, StandOnTheSceneOfTheirNames) {
    const PlacedPlants placed = some_plants(500);
    const ScratchFile plants("scene.plants", write_placed(placed));
    auto scene = load_scene_text(k_scene);
    ASSERT_TRUE(scene) << to_string(scene.error());
    ASSERT_EQ(scene->positions.size(), 500u);
    size_t oaks = 0, placed_oaks = 0;
    for (const PlantModel& model : scene->plant_models) oaks += scene->models[model.model].name == "oak";
    for (const PlacedPlant& plant : placed.plants) placed_oaks += placed.kinds[plant.kind] == "oak";
    EXPECT_EQ(oaks, placed_oaks);
    for (const SceneTile& tile : scene->tiles)
        for (uint32_t i = tile.first_plant; i < tile.first_plant + tile.plant_count; ++i) {
            const PlantPosition& p = scene->positions[i];
            const dvec3 at = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile);
            EXPECT_NEAR(at.y, double(scene->terrain->height_at(float(at.x), float(at.z))), 0.01);
        }
}

TEST(PlacedPlants, OfANameThatTheSceneLacksAreRefusedWithTheNearest) {
    const ScratchFile plants("scene.plants", write_placed({{"oaks"}, {PlacedPlant{}}}));
    auto scene = load_scene_text(k_scene);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().id, ErrorId::name_unknown);
    EXPECT_EQ(scene.error().place, "placements[0].packed");
    EXPECT_NE(scene.error().remedy.find("did you mean 'oak'"), std::string::npos) << scene.error().remedy;
}

TEST(PlacedPlants, MayComeFromMemory) {
    const std::string bytes = write_placed(some_plants(10));
    static constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
    SceneLoadSettings settings{&k_terrain};
    std::vector<std::string> asked;
    settings.read_file = [&](const std::string& path) -> Result<std::string> {
        asked.push_back(path);
        return path.ends_with(".plants") ? bytes : std::string(k_scene);
    };
    auto scene = load_scene("nowhere/scene.eco.json", settings);
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(scene->positions.size(), 10u);
    EXPECT_EQ(asked, (std::vector<std::string>{"nowhere/scene.eco.json", "nowhere/scene.plants"}));
}

}  // namespace
}  // namespace coppice
