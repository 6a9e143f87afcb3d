// Plants of a population in colours of their own, and the population in the colour it had.
#include "plugins/vegetation/eco/vary_color.h"

#include <map>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/make_cloud.h"
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/hash.h"
#include "tests/eco/cloud_plants.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

constexpr vec3 k_colors[] = {vec3(0.09f, 0.16f, 0.04f), vec3(0.2f, 0.15f, 0.1f), vec3(0.5f, 0.5f, 0.5f),
                             vec3(0.6f, 0.45f, 0.2f), vec3(0.03f, 0.05f, 0.02f)};

// What nothing of these colours is cut off by.
constexpr ColorVariation k_variation{0.3f, 12.0f, 0.25f};

float hue_rad(vec3 c) { return std::atan2(0.8660254f * (c.y - c.z), c.x - 0.5f * (c.y + c.z)); }

TEST(VaryColor, TheMeanOverPlantsStays) {
    for (const ColorVariation& variation :
         {k_variation, ColorVariation{0.5f, 0.0f, 0.0f}, ColorVariation{0.0f, 15.0f, 0.0f}, ColorVariation{0.0f, 0.0f, 0.3f}}) {
        const ColorTints tints(variation);
        for (const vec3& color : k_colors) {
            dvec3 sum(0.0);
            constexpr uint32_t k_plants = 200000;
            for (uint32_t plant = 0; plant < k_plants; ++plant)
                sum += dvec3(tint_color(tints.tint_of(mix_bits(plant + 1)), color));
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(sum[c] / k_plants / double(color[c]), 1.0, 0.005) << variation.hue_deg << " " << color.y << " " << c;
        }
    }
}

TEST(VaryColor, PlantsDifferAsMuchAsIsAskedFor) {
    const vec3 color = k_colors[0];
    float darkest = 1.0f, brightest = 0.0f, most_turn = 0.0f;
    for (uint32_t plant = 0; plant < 20000; ++plant) {
        const uint32_t seed = mix_bits(plant);
        const vec3 bright = tint_color(ColorTints({0.3f, 0.0f, 0.0f}).tint_of(seed), color);
        darkest = std::min(darkest, bright.y / color.y);
        brightest = std::max(brightest, bright.y / color.y);
        const vec3 turned = tint_color(ColorTints({0.0f, 12.0f, 0.0f}).tint_of(seed), color);
        most_turn = std::max(most_turn, std::abs(hue_rad(turned) - hue_rad(color)));
    }
    EXPECT_NEAR(darkest, 0.7f, 0.01f);
    EXPECT_NEAR(brightest, 1.3f, 0.01f);
    EXPECT_NEAR(most_turn * 180.0f / k_pi, 12.0f, 1.0f);
    EXPECT_EQ(ColorTints(ColorVariation{}).tint_of(77), 0u);
    EXPECT_EQ(tint_color(0, color), color);
}

TEST(VaryColor, WordsKeepTheLinearMeanAndAllElse) {
    const uint32_t tint = ColorTints(k_variation).tint_of(12345);
    const uint32_t word = encode_surface({vec3(0.6f, 0.8f, 0.0f), k_colors[0], 0.6f, true}, 9);
    const vec3 expected = tint_color(tint, decode_surface(word).color_linear);
    dvec3 sum(0.0);
    for (uint32_t i = 0; i < 50000; ++i) {
        const uint32_t tinted = tint_surface(tint, word, mix_bits(i));
        ASSERT_EQ(tinted & 0xf0000fffu, word & 0xf0000fffu);
        sum += dvec3(decode_surface(tinted).color_linear);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / 50000 / double(expected[c]), 1.0, 0.01);
    EXPECT_EQ(tint_surface(0, word, 5), word);
}

// A cloud's points carry their plants' tints: same points, and the mean of all is that of the cloud without.
TEST(VaryColor, CloudsCarryTheTintsAndKeepTheMean) {
    HandPlant hand;
    hand.add_points(64, 2.0f);
    Plant plant = hand.view();
    std::vector<PackedVertex> points(plant.points.begin(), plant.points.end());
    for (PackedVertex& point : points) point.surface = encode_surface({vec3(0, 1, 0), k_colors[3], 1.0f, true}, point.surface);
    plant.points = points;
    std::vector<PlantPosition> positions;
    std::vector<PlantTurn> turns;
    std::vector<PlantModel> models;
    for (uint32_t i = 0; i < 400; ++i) {
        positions.push_back({100.0f * float(i), 0.0f, 0.0f, 1.0f});
        turns.push_back({0, 0, 0, 32767});
        models.push_back({0, mix_bits(i + 3)});
    }
    SceneModel plain, varied;
    varied.color_variation = k_variation;
    const TileCloud before = gather_cloud(positions, turns, models, {&plant, 1}, {&plain, 1});
    const TileCloud after = gather_cloud(positions, turns, models, {&plant, 1}, {&varied, 1});
    ASSERT_EQ(before.points.size(), after.points.size());
    dvec3 mean_before(0.0), mean_after(0.0);
    std::map<int, dvec3> of_plant;
    for (size_t i = 0; i < after.points.size(); ++i) {
        ASSERT_EQ(before.points[i].x_plant, after.points[i].x_plant);
        ASSERT_EQ(before.points[i].surface & 0xf0000fffu, after.points[i].surface & 0xf0000fffu);
        const dvec3 color(decode_surface(after.points[i].surface).color_linear);
        mean_before += dvec3(decode_surface(before.points[i].surface).color_linear) / double(before.points.size());
        mean_after += color / double(after.points.size());
        of_plant[int(after.points[i].x_plant / 100.0f + 0.5f)] += color;
    }
    const ColorTints tints(k_variation);
    double error = 0.0;
    for (const auto& [index, sum] : of_plant) {
        const double count = double(after.points.size()) / double(of_plant.size());
        error += std::abs(sum.y / count / double(tint_color(tints.tint_of(models[size_t(index)].seed), k_colors[3]).y) - 1.0);
    }
    EXPECT_LT(error / double(of_plant.size()), 0.1);  // of twenty points each, by chance
    // 400 plants: 0.17 over the root of them by chance.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean_after[c] / mean_before[c], 1.0, 0.03);
    EXPECT_EQ(before.part.mean_color_linear[1], after.part.mean_color_linear[1]);
}

TEST(VaryColor, ScenesSayIt) {
    auto scene_of = [](const std::string& variation) {
        return load_scene_text(R"({"plants": {"oak": {"source": "oak.json", "variations": 2, "color_variation": )" + variation +
                               R"(}}, "placements": [{"plant": "oak", "at": [0, 0, 0]}]})");
    };
    const auto scene = scene_of(R"({"brightness": 0.2, "hue_deg": 9})");
    ASSERT_TRUE(scene) << to_string(scene.error());
    for (const SceneModel& model : scene->models)
        EXPECT_EQ(model.color_variation, (ColorVariation{0.2f, 9.0f, 0.0f}));
    for (const auto& [variation, place] : std::vector<std::pair<std::string, std::string>>{
             {R"({"brightness": 1})", "brightness"}, {R"({"hue_deg": -3})", "hue_deg"}, {R"({"saturation": "much"})", "saturation"},
             {R"({"hue": 3})", ""}, {"3", ""}}) {
        const auto bad = scene_of(variation);
        ASSERT_FALSE(bad) << variation;
        EXPECT_NE(bad.error().place.find("plants.oak.color_variation" + (place.empty() ? "" : "." + place)), std::string::npos)
            << to_string(bad.error());
    }
}

}  // namespace
}  // namespace coppice
