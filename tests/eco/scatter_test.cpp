#include "plugins/vegetation/eco/scatter.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/terrain/load_terrain.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

Region rectangle(double width, double depth, dvec2 center = dvec2(0.0)) {
    RegionShape shape;
    shape.kind = RegionShape::Kind::rectangle;
    shape.center = center;
    shape.half_size = dvec2(width, depth) * 0.5;
    return {{shape}};
}

Region circle(double radius, dvec2 center = dvec2(0.0)) {
    RegionShape shape;
    shape.center = center;
    shape.radius_m = radius;
    return {{shape}};
}

ScatterSettings over(Region region) {
    ScatterSettings settings;
    settings.species = {{{{{0}}, 10.0f}, 1.0f}};
    settings.region = std::move(region);
    return settings;
}

std::vector<Placement> run(const ScatterSettings& settings) {
    auto plants = scatter(settings, "scene", "scatter");
    EXPECT_TRUE(plants.has_value()) << (plants ? "" : to_string(plants.error()));
    return plants ? *plants : std::vector<Placement>();
}

uint64_t hash_of(const std::vector<Placement>& plants) {
    uint64_t hash = 0;
    for (const Placement& p : plants) {
        double at[3] = {p.position_world.x, p.position_world.y, p.position_world.z};
        hash = hash_bytes(at, sizeof(at), hash);
        hash = hash_bytes(&p.scale, sizeof(float), hash);
        hash = hash_bytes(&p.turn, sizeof(p.turn), hash);
        hash = hash_bytes(&p.model, sizeof(p.model), hash);
    }
    return hash;
}

double least_distance(std::vector<Placement> plants) {
    std::sort(plants.begin(), plants.end(),
              [](const auto& a, const auto& b) { return a.position_world.x < b.position_world.x; });
    double least = INFINITY;
    for (size_t i = 0; i < plants.size(); ++i)
        for (size_t j = i + 1; j < plants.size(); ++j) {
            dvec3 d = plants[j].position_world - plants[i].position_world;
            if (d.x >= least) break;
            least = std::min(least, std::sqrt(d.x * d.x + d.z * d.z));
        }
    return least;
}

TEST(Scatter, DensityIsThatAskedFor) {
    ScatterSettings settings = over(circle(100.0));
    settings.density_per_m2 = 0.8;
    double expected = 0.8 * 3.14159265 * 1e4;
    EXPECT_NEAR(double(run(settings).size()), expected, 0.02 * expected);
    settings.spacing_m = 0.7;  // half of what is possible: spacing must not cost density
    EXPECT_NEAR(double(run(settings).size()), expected, 0.03 * expected);
}

TEST(Scatter, SpacingIsRespected) {
    ScatterSettings settings = over(rectangle(80.0, 50.0, dvec2(500.0, -300.0)));
    settings.density_per_m2 = 0.12;
    settings.spacing_m = 2.0;
    auto plants = run(settings);
    EXPECT_GT(plants.size(), 440u);
    EXPECT_GE(least_distance(plants), 2.0);
    settings.spacing_m = 0.0;
    EXPECT_LT(least_distance(run(settings)), 1.0);  // the spacing did it
}

TEST(Scatter, CountIsExact) {
    for (uint64_t count : {1ull, 7ull, 640ull, 20000ull}) {
        ScatterSettings settings = over(circle(60.0));
        settings.count = count;
        settings.spacing_m = count < 1000 ? 2.0 : 0.0;
        settings.exclude = circle(40.0);
        auto plants = run(settings);
        EXPECT_EQ(plants.size(), count);
        for (const Placement& p : plants) {
            double away = glm::length(dvec2(p.position_world.x, p.position_world.z));
            ASSERT_TRUE(away > 40.0 && away < 60.0);
        }
        EXPECT_TRUE(count == 1 || least_distance(plants) >= settings.spacing_m);
    }
}

TEST(Scatter, GridStandsInItsPlaces) {
    ScatterSettings settings = over(rectangle(2000, 2000));
    settings.grid_spacing_m = 7.0;
    settings.grid_jitter_m = 2.45;
    settings.grid_columns = 20;
    settings.grid_rows = 32;
    auto plants = run(settings);
    ASSERT_EQ(plants.size(), 640u);
    double worst = 0.0;
    for (size_t i = 0; i < plants.size(); ++i) {
        double x = (double(i % 20) - 9.5) * 7.0, z = (double(i / 20) - 15.5) * 7.0;
        worst = std::max(
            {worst, std::abs(plants[i].position_world.x - x), std::abs(plants[i].position_world.z - z)});
    }
    EXPECT_LE(worst, 2.45);
    EXPECT_GT(worst, 2.3);
    settings.grid_columns = settings.grid_rows = 0;
    settings.grid_jitter_m = 0.0;
    settings.region = rectangle(70, 35);
    EXPECT_EQ(run(settings).size(), 50u);
}

TEST(Scatter, SameOnAnyNumberOfThreads) {
    ScatterSettings settings = over(circle(300.0));
    settings.density_per_m2 = 0.5;
    settings.spacing_m = 0.8;
    settings.noisy = true;
    settings.noise.from = 0.4f;
    settings.lean_most_rad = 0.2f;
    set_thread_limit(1);
    uint64_t one = hash_of(run(settings));
    settings.spacing_m = 0.0;
    uint64_t one_free = hash_of(run(settings));
    set_thread_limit(0);
    EXPECT_EQ(one_free, hash_of(run(settings)));
    settings.spacing_m = 0.8;
    EXPECT_EQ(one, hash_of(run(settings)));
    settings.seed = 2;
    EXPECT_NE(one, hash_of(run(settings)));
}

TEST(Scatter, NoisyScattersFillWhatTheOtherLeaves) {
    ScatterSettings settings = over(rectangle(400, 400));
    settings.density_per_m2 = 0.2;
    settings.noisy = true;
    settings.noise = {40.0f, 0.5f, 3.0f, 0.02f, 3, 9};
    auto wood = run(settings);
    settings.noise.from = -2.0f;
    settings.noise.to = 0.5f;
    auto meadow = run(settings);
    EXPECT_NEAR(double(wood.size() + meadow.size()), 0.2 * 160000, 0.03 * 0.2 * 160000);
    EXPECT_GT(wood.size(), 8000u);
    EXPECT_GT(meadow.size(), 8000u);
    // Clumps: a cell of 10 m is mostly full or empty, which chance alone would not do.
    std::vector<int> cells(1600, 0);
    for (const Placement& p : wood)
        ++cells[size_t((p.position_world.z + 200) / 10) * 40 + size_t((p.position_world.x + 200) / 10)];
    EXPECT_GT(std::count_if(cells.begin(), cells.end(), [](int n) { return n <= 2; }), 300);
    EXPECT_GT(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 14; }), 300);
}

TEST(Scatter, NoiseWithAPeriodRepeats) {
    ScatterSettings settings = over(rectangle(200, 100));
    settings.density_per_m2 = 0.5;
    settings.noisy = true;
    settings.noise = {25.0f, 0.5f, 3.0f, 0.02f, 3, 9, 100.0};
    int cells[10][20] = {};
    for (const Placement& p : run(settings))
        ++cells[size_t((p.position_world.z + 50) / 10)][size_t((p.position_world.x + 100) / 10)];
    int a_period_apart = 0, half_apart = 0;
    for (const auto& row : cells)
        for (size_t i = 0; i < 10; ++i) {
            a_period_apart += std::abs(row[i] - row[i + 10]);
            half_apart += std::abs(row[i] - row[i + 5]);
        }
    EXPECT_LT(3 * a_period_apart, half_apart);
}

TEST(Scatter, WeightsVariationsScalesAndTurnsAreDrawn) {
    ScatterSettings settings = over(rectangle(200, 200));
    settings.species = {{{{{0}, {1}, {2}}, 10.0f}, 3.0f}, {{{{3}}, 5.0f}, 1.0f}};
    settings.density_per_m2 = 1.0;
    settings.scale_low = 0.5f;
    settings.scale_high = 1.5f;
    auto plants = run(settings);
    std::vector<double> share(4, 0.0);
    double scale = 0.0, turned = 0.0;
    for (const Placement& p : plants) {
        share[p.model.model] += 1.0 / double(plants.size());
        scale += double(p.scale) / double(plants.size());
        turned += (p.turn.w < 0 ? 1.0 : 0.0) / double(plants.size());
        ASSERT_TRUE(p.scale >= 0.5f && p.scale < 1.5f);
        ASSERT_EQ(p.turn.x, 0);
        ASSERT_EQ(p.turn.z, 0);
    }
    EXPECT_NEAR(share[0], 0.25, 0.02);
    EXPECT_NEAR(share[2], 0.25, 0.02);
    EXPECT_NEAR(share[3], 0.25, 0.02);
    EXPECT_NEAR(scale, 1.0, 0.02);
    EXPECT_NEAR(turned, 0.5, 0.02);
    settings.height_low_m = settings.height_high_m = 20.0f;
    for (const Placement& p : run(settings)) ASSERT_EQ(p.scale, p.model.model == 3 ? 4.0f : 2.0f);
}

TEST(Scatter, ObeysTheTerrain) {
    auto terrain = *load_terrain(
        R"({"procedural": {"size_m": 256, "cell_m": 2, "amplitude_m": 25, "wavelength_m": 70}})", ".", "x");
    ScatterSettings settings = over(rectangle(256, 256));
    settings.terrain = terrain.get();
    settings.density_per_m2 = 0.2;
    settings.rule.slope_most_rad = 0.3f;
    settings.rule.altitude_low_m = 0.0f;
    settings.edge_m = 20.0f;
    settings.rule.align_to_ground = 1.0f;
    auto plants = run(settings);
    EXPECT_GT(plants.size(), 500u);
    EXPECT_LT(plants.size(), 9000u);
    size_t at_border = 0;
    for (const Placement& p : plants) {
        float x = float(p.position_world.x), z = float(p.position_world.z);
        ASSERT_EQ(p.position_world.y, double(terrain->height_at(x, z)));
        ASSERT_GE(p.position_world.y, 0.0);
        ASSERT_GE(terrain->normal_at(x, z).y, portable_cos(0.3f) - 1e-6f);
        at_border += std::max(std::abs(x), std::abs(z)) > 126.0f;
        // The plant's up is the ground's.
        float s = 1.0f / 32767.0f, qx = p.turn.x * s, qy = p.turn.y * s, qz = p.turn.z * s, qw = p.turn.w * s;
        vec3 up(2 * (qx * qy - qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz + qw * qx));
        ASSERT_GT(glm::dot(up, terrain->normal_at(x, z)), 0.9999f);
    }
    EXPECT_LT(at_border, 20u);  // the edge is thin
}

TEST(Scatter, RefusesWhatCannotBe) {
    ScatterSettings settings = over(rectangle(10, 10));
    settings.density_per_m2 = 1.0;
    settings.spacing_m = 2.0;
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::value_out_of_range);
    settings.density_per_m2 = 0.0;
    settings.count = 1000;
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::value_out_of_range);
    settings.spacing_m = 0.0;
    settings.exclude = rectangle(20, 20);
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::value_out_of_range);
    settings = over(rectangle(1e7, 1e7));
    settings.density_per_m2 = 1e5;
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::limit_exceeded);
    settings = over(rectangle(1e4, 1e4));
    settings.density_per_m2 = 1.0;
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::limit_exceeded);
    settings.density_per_m2 = 0.0;
    settings.grid_spacing_m = 0.001;
    EXPECT_EQ(scatter(settings, "f", "p").error().id, ErrorId::limit_exceeded);
}

}  // namespace
}  // namespace coppice
