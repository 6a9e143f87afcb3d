// Stands that thin themselves as they grow.
#include "plugins/vegetation/eco/compete.h"

#include <cmath>
#include <gtest/gtest.h>
#include "runtime/core/random.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

constexpr double k_side_m = 120.0;

std::vector<Competitor> seedlings(uint32_t count, uint64_t seed) {
    Random random(seed);
    std::vector<Competitor> plants;
    for (uint32_t i = 0; i < count; ++i) {
        const double x = double(random.next_unit()), z = double(random.next_unit());
        plants.push_back({dvec2(x, z) * k_side_m, 0.2 + 0.4 * double(random.next_unit()), 12.0, i});
    }
    return plants;
}

// The slope of log mean mass over log density while a stand thins, mass being the cube of the radius.
double slope_of(uint32_t count, uint64_t seed, double growth) {
    std::vector<Competitor> plants = compete(seedlings(count, seed), 0, 0.0);
    std::vector<dvec2> logs;
    while (plants.size() > 60) {
        plants = compete(std::move(plants), 3, growth);
        double mass = 0.0;
        for (const Competitor& each : plants) mass += each.radius_m * each.radius_m * each.radius_m;
        // From when half have died: before, most have not met yet.
        if (plants.size() < count / 2) logs.emplace_back(std::log(double(plants.size())), std::log(mass / double(plants.size())));
    }
    dvec2 mean(0.0);
    for (const dvec2& each : logs) mean += each / double(logs.size());
    double xx = 0.0, xy = 0.0;
    for (const dvec2& each : logs) {
        xx += (each.x - mean.x) * (each.x - mean.x);
        xy += (each.x - mean.x) * (each.y - mean.y);
    }
    return xy / xx;
}

// Deussen et al. 1998: the -3/2 law of self-thinning. Measured: -1.50 to -1.55.
TEST(Compete, MassFollowsTheDensityByTheLawOfSelfThinning) {
    for (double growth : {0.03, 0.1})
        for (uint64_t seed : {1, 2, 3}) {
            const double slope = slope_of(12000, seed, growth);
            EXPECT_NEAR(slope, -1.5, 0.1) << seed << " " << growth;
            RecordProperty("slope_" + std::to_string(seed) + (growth < 0.05 ? "_slow" : "_fast"), std::to_string(slope));
        }
}

TEST(Compete, NoCirclesMeetAndTheLargerLives) {
    const std::vector<Competitor> left = compete(seedlings(3000, 7), 25, 0.08);
    ASSERT_GT(left.size(), 20u);
    for (size_t i = 0; i < left.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            EXPECT_GE(glm::length(left[i].at - left[j].at), left[i].radius_m + left[j].radius_m - 1e-9);
    EXPECT_EQ(compete({{{0, 0}, 1.0, 1.0, 0}, {{1.5, 0}, 2.0, 2.0, 1}}, 0, 0.0).front().plant, 1u);
    EXPECT_EQ(compete({{{0, 0}, 1.0, 1.0, 0}, {{1.5, 0}, 1.0, 1.0, 1}}, 0, 0.0).front().plant, 0u);
    EXPECT_TRUE(compete({}, 5, 0.1).empty());
}

TEST(Compete, RulesOfScenesGrowUp) {
    auto scene_of = [](const std::string& compete) {
        return load_scene_text(R"({"plants": {"oak": {"source": "oak.json"}}, "terrain": {"flat": {"size_m": 100, "cell_m": 4}},
            "placements": [{"scatter": {"plant": "oak", "count": 4000, "scale": [0.05, 0.15])" + compete + "}}]}");
    };
    const auto seeds = scene_of(""), grown = scene_of(R"(, "compete": {"crown_radius_m": 4, "steps": 30, "growth": 0.08})"),
               again = scene_of(R"(, "compete": {"crown_radius_m": 4, "steps": 30, "growth": 0.08})");
    ASSERT_TRUE(seeds && grown && again);
    EXPECT_EQ(seeds->positions.size(), 4000u);
    ASSERT_GT(grown->positions.size(), 50u);
    EXPECT_LT(grown->positions.size(), 1000u);
    ASSERT_EQ(grown->positions.size(), again->positions.size());
    for (size_t i = 0; i < grown->positions.size(); ++i) {
        EXPECT_LE(grown->positions[i].scale, 1.0f);
        EXPECT_EQ(grown->positions[i].x_tile, again->positions[i].x_tile);
    }
    const auto bad = scene_of(R"(, "compete": {"steps": 3})");
    ASSERT_FALSE(bad);
    EXPECT_NE(bad.error().place.find("scatter.compete.crown_radius_m"), std::string::npos);
}

}  // namespace
}  // namespace coppice
