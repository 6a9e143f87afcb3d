// Copies of periodic ground stand beside each other as one.
#include <algorithm>
#include <cstring>
#include <map>
#include <gtest/gtest.h>
#include "plugins/terrain/color_ground.h"
#include "plugins/terrain/grow_heights.h"
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {
namespace {

constexpr const char* k_periodic =
    R"({"procedural": {"size_m": 256, "cell_m": 2, "seed": 5, "amplitude_m": 12, "wavelength_m": 60, "ridges": 0.4,
        "periodic": true}})";

GrowHeightsSettings settings() {
    GrowHeightsSettings s;
    s.size_m = 256.0f;
    s.cell_m = 2.0f;
    s.amplitude_m = 12.0f;
    s.wavelength_m = 60.0f;
    s.ridges = 0.4f;
    s.seed = 5;
    s.periodic = true;
    return s;
}

// The field beside itself: as its copies stand, without a border where they meet.
HeightField doubled(const HeightField& field) {
    HeightField wide;
    const uint32_t period = field.columns - 1;
    wide.columns = wide.rows = 2 * period + 1;
    wide.cell_m = field.cell_m;
    for (uint32_t row = 0; row < wide.rows; ++row)
        for (uint32_t column = 0; column < wide.columns; ++column)
            wide.heights_m.push_back(field.sample(column % period, row % period));
    return wide;
}

TEST(Periodic, OppositeBordersHaveTheSameHeightsAndNoStep) {
    HeightField field = grow_heights(settings());
    float inside = 0.0f, across = 0.0f;
    for (uint32_t i = 0; i < field.columns; ++i) {
        const uint32_t end = field.columns - 1;
        ASSERT_EQ(field.sample(i, 0), field.sample(i, end));
        ASSERT_EQ(field.sample(0, i), field.sample(end, i));
        // The steepest second difference over the border is like those inside: the ground goes on smoothly.
        across = std::max(
            across, std::fabs(field.sample(end - 1, i) - 2.0f * field.sample(0, i) + field.sample(1, i)));
        for (uint32_t column = 1; column < end; ++column)
            inside = std::max(inside, std::fabs(field.sample(column - 1, i) - 2.0f * field.sample(column, i) +
                                                field.sample(column + 1, i)));
    }
    EXPECT_LT(across, inside);
    auto [low, high] = std::minmax_element(field.heights_m.begin(), field.heights_m.end());
    EXPECT_GT(*high - *low, 12.0f);
}

TEST(Periodic, NormalsAtTheBorderAreThoseOfGroundThatGoesOn) {
    HeightField field = grow_heights(settings()), wide = doubled(field);
    std::vector<vec3> normals = make_normals(field), around = make_normals(wide);
    const uint32_t period = field.columns - 1;
    for (uint32_t i = 0; i < period; ++i)
        for (auto [column, row] :
             {std::pair(0u, i), std::pair(period, i), std::pair(i, 0u), std::pair(i, period)}) {
            // Where copies meet there is ground on all sides.
            uint32_t c = column == 0 ? period : column, r = row == 0 ? period : row;
            ASSERT_EQ(normals[size_t(row) * field.columns + column], around[size_t(r) * wide.columns + c]);
        }
}

TEST(Periodic, GroundColorsAgreeOnOppositeBordersAndGoOn) {
    HeightField field = grow_heights(settings());
    GroundSettings ground;
    ground.patch_m = 30.0f;
    std::vector<vec3> colors = color_ground(field, make_normals(field), ground, dvec3(0.0));
    const uint32_t end = field.columns - 1;
    auto color = [&](uint32_t column, uint32_t row) { return colors[size_t(row) * field.columns + column]; };
    double inside = 0.0, across = 0.0;
    for (uint32_t i = 0; i <= end; ++i) {
        ASSERT_EQ(color(i, 0), color(i, end));
        ASSERT_EQ(color(0, i), color(end, i));
        across += double(glm::length(color(end - 1, i) - color(end, i)));
        inside += double(glm::length(color(end / 2, i) - color(end / 2 + 1, i)));
    }
    EXPECT_LT(across, 1.5 * inside);
    EXPECT_GT(across, 0.0);
}

// What is drawn: of every level, the vertices on opposite borders differ in their place only.
TEST(Periodic, VerticesOfEveryLevelAgreeAlsoUnderShadeThatCrossesTheBorder) {
    auto loaded = load_terrain(k_periodic, ".", "scene.eco.json");
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    Terrain& terrain = **loaded;
    terrain.shade(-126.3f, 20.0f, 15.0f, 0.6f);
    terrain.shade(127.1f, -127.9f, 9.0f, 0.5f);
    terrain.shade(30.0f, 3.0f * 256.0f - 128.0f, 7.0f, 0.4f);  // as if on the border
    const TerrainLayout layout = terrain.layout();
    const float size = float(layout.cells_x) * layout.cell_m;
    size_t compared = 0;
    float darkest = 1.0f, open = 1.0f;
    for (uint32_t level = 0; level < 6; ++level) {
        // Level by level, vertices of the upper surface by their place.
        std::map<std::pair<float, float>, std::pair<float, uint32_t>> at;
        for (const TerrainPatch& patch : terrain.patches()) {
            const TerrainLevel& l = terrain.levels()[patch.first_level + level];
            const uint32_t across = k_patch_cells >> level;
            for (uint32_t v = l.first_vertex; v < l.first_vertex + 6 * across * across; ++v) {
                const PackedVertex& p = terrain.vertices()[v];
                at[{p.x_plant, p.z_plant}] = {p.y_plant, p.surface};
            }
        }
        for (const auto& [place, vertex] : at) {
            if (place.first == -0.5f * size) {
                ASSERT_EQ(vertex, at.at({0.5f * size, place.second})) << level;
                darkest = std::min(darkest, decode_surface(vertex.second).openness);
                ++compared;
            }
            if (place.second == -0.5f * size) {
                ASSERT_EQ(vertex, at.at({place.first, 0.5f * size})) << level;
                if (level == 0 && place.first == 30.0f) open = decode_surface(vertex.second).openness;
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 2u * (128 + 64 + 32 + 16 + 8 + 4));
    EXPECT_LT(darkest, 0.6f);
    EXPECT_LT(open, 0.9f) << "shade from beyond the border";
}

TEST(Periodic, GroundGoesOnOutsideTheField) {
    auto loaded = load_terrain(k_periodic, ".", "scene.eco.json");
    ASSERT_TRUE(loaded);
    const Terrain& terrain = **loaded;
    for (float x : {-100.25f, 3.5f, 90.75f})
        for (float z : {-40.5f, 77.0f}) {
            EXPECT_NEAR(terrain.height_at(x + 256.0f, z - 512.0f), terrain.height_at(x, z), 1e-3f);
            EXPECT_NEAR(glm::length(terrain.normal_at(x - 256.0f, z) - terrain.normal_at(x, z)), 0.0f, 1e-3f);
        }
    EXPECT_TRUE(std::isfinite(terrain.height_at(1e30f, NAN)));
}

TEST(Periodic, WhatCannotRepeatIsRefused) {
    struct Case {
        const char* more;
        const char* place;
    };
    for (const Case& bad : std::initializer_list<Case>{
             {R"("rim_m": 5)", "terrain.procedural.rim_m"},
             {R"("valley": {"from": [0, 0], "to": [1, 1]})", "terrain.procedural.valley"},
             {R"("level": {"center": [0, 0], "radius_m": 5})", "terrain.procedural.level"},
             {R"("wavelength_m": 300)", "terrain.procedural.wavelength_m"},
             {R"("wavelength_m": 0.1, "octaves": 16, "size_m": 100000, "cell_m": 100)",
              "terrain.procedural.wavelength_m"},
         }) {
        std::string json = std::string(R"({"procedural": {"periodic": true, )") +
                           (std::strstr(bad.more, "size_m") ? "" : R"("size_m": 256, )") + bad.more + "}}";
        auto terrain = load_terrain(json, ".", "scene.eco.json");
        ASSERT_FALSE(terrain) << json;
        EXPECT_EQ(terrain.error().id, ErrorId::value_out_of_range);
        EXPECT_EQ(terrain.error().place, bad.place);
    }
    auto painted = [](double x) {
        return R"({"procedural": {"periodic": true, "size_m": 256}, "center": [1000, 0, 0], "ground": {"paint": [{"edge_m": 5,
               "region": {"circle": {"center": [)" +
               std::to_string(x) + R"(, 0], "radius_m": 10}}}]}})";
    };
    auto over = load_terrain(painted(1115.0), ".", "scene.eco.json");
    ASSERT_FALSE(over);
    EXPECT_EQ(over.error().place, "terrain.ground.paint[0].region");
    EXPECT_TRUE(load_terrain(painted(1100.0), ".", "scene.eco.json"));
}

}  // namespace
}  // namespace coppice
