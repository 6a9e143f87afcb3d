// Plants where another program's file has nodes called like them.
#include "plugins/vegetation/eco/place_named.h"

#include <gtest/gtest.h>
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

const std::vector<NamedPlaces> k_stand{
    {{"oak.001"}, "nodes[0]", {{{1, 2, 3}, 1.5, {0, 0, 0, 1}}, {{4, 5, 6}, 2.0, {0, 1, 0, 0}}}},
    {{"node 7", "QURO"}, "nodes[1]", {{{7, 0, 9}, 1.0, {0, 0, 0, 1}}}},
    {{"camera"}, "nodes[2]", {{{0, 0, 0}, 1.0, {0, 0, 0, 1}}}},
};

PlaceNamedSettings settings() {
    PlaceNamedSettings settings;
    settings.kinds["oak"].individuals = {{0, 1.0f}, {1, 1.0f}, {2, 0.5f}};
    settings.kinds["QURO"] = settings.kinds["oak"];
    settings.offset = {100, 0, 0};
    return settings;
}

TEST(PlaceNamed, NodesAndMeshesByName) {
    const auto plants = place_named(k_stand, settings(), "stand.glb");
    ASSERT_TRUE(plants) << to_string(plants.error());
    ASSERT_EQ(plants->size(), 3u);
    EXPECT_EQ((*plants)[0].position_world, dvec3(101, 2, 3));
    EXPECT_EQ((*plants)[0].scale, 1.5f);
    EXPECT_EQ((*plants)[0].model.model, 1u);
    EXPECT_EQ((*plants)[1].model.model, 1u);
    EXPECT_EQ((*plants)[1].turn.y, 32767);
    EXPECT_EQ((*plants)[2].position_world, dvec3(107, 0, 9));
    EXPECT_NE((*plants)[0].model.seed, (*plants)[1].model.seed);
}

TEST(PlaceNamed, FaultsAreNamed) {
    auto place = [](NamedPlaces many) { return place_named({std::move(many)}, settings(), "stand.glb"); };
    const auto unknown = place({{"oka"}, "nodes[0]", {{{0, 0, 0}, 1.0, {0, 0, 0, 1}}}});
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().id, ErrorId::name_unknown);
    EXPECT_NE(unknown.error().remedy.find("'oak'"), std::string::npos) << unknown.error().remedy;
    const auto far = place({{"oak"}, "nodes[3]", {{{1e8, 0, 0}, 1.0, {0, 0, 0, 1}}}});
    ASSERT_FALSE(far);
    EXPECT_EQ(far.error().place, "nodes[3]");
    EXPECT_FALSE(place({{"oak"}, "nodes[0]", {{{0, 0, 0}, 1e7, {0, 0, 0, 1}}}}));
    EXPECT_FALSE(place_named({}, settings(), "stand.glb"));
}

TEST(PlaceNamed, ScenesNameTheFile) {
    const ScratchFile file("scene.eco.json", R"({"plants": {"oak": {"source": "oak.json", "variations": 3}},
        "placements": [{"gltf": "stand.glb", "offset": [-1, 10, 0], "species": {"camera": "oak"}}]})");
    SceneLoadSettings load;
    EXPECT_EQ(load_scene(file.path(), load).error().place, "placements[0].gltf");
    std::string asked;
    load.read_gltf = [&](const std::string& path) -> Result<std::vector<NamedPlaces>> {
        asked = path;
        return k_stand;
    };
    const auto scene = load_scene(file.path(), load);
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_TRUE(asked.ends_with("/stand.glb")) << asked;
    ASSERT_EQ(scene->positions.size(), 3u);  // two oaks and the camera
    double highest = 0.0;
    for (const SceneTile& tile : scene->tiles)
        for (uint32_t i = tile.first_plant; i < tile.first_plant + tile.plant_count; ++i)
            highest = std::max(highest, tile.tile.origin_world.y + double(scene->positions[i].y_tile));
    EXPECT_NEAR(highest, 15.0, 1e-3);
}

}  // namespace
}  // namespace coppice
