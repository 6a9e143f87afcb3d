#include "plugins/vegetation/eco/point_demand.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/vegetation/lod/choose_part.h"
#include "tests/eco/cloud_plants.h"

namespace coppice {
namespace {

constexpr vec3 k_any_side(0.6f, 0.0f, -0.8f);

TEST(PointDemand, IsWhatAPartDraws) {
    Random random(1);
    for (int round = 0; round < 40; ++round) {
        HandPlant plant;
        PackedPart& part = plant.add_points(2000, random.next_in(0.01f, 30.0f));
        roughen_gains(part, random);
        const PointDemand demand(part);
        ASSERT_EQ(demand.stored_count(), 2000u);
        for (float per_meter = 0.02f;; per_meter *= 1.3f) {
            const double count = demand.count(double(per_meter) * double(per_meter));
            if (count > 1900.0) break;
            const PartChoice drawn = choose_part(part, {k_any_side, per_meter}, {}, 0.5f);
            ASSERT_NEAR(double(drawn.points), count, 0.501 + 1e-4 * count) << per_meter;
        }
    }
}

// Far away as many points; nearer, lines that cover as much as they would.
TEST(PointDemand, OfLinesIsTheAreaTheyCover) {
    Random random(2);
    bool points = false, lines = false;
    for (int round = 0; round < 40; ++round) {
        HandPlant plant;
        const std::vector<float> widths(5000, 1.0f);
        PackedPart& part = plant.add_lines(widths, random.next_in(0.1f, 3.0f));
        roughen_gains(part, random);
        const PointDemand demand(part);
        for (float per_meter = 0.05f;; per_meter *= 1.3f) {
            const PlantView view{k_any_side, per_meter};
            const PartChoice drawn = choose_part(part, view, {}, 0.5f);
            if (drawn.triangles > 0) break;
            const double asked = demand.count(double(per_meter) * double(per_meter));
            if (drawn.lines == 0) {
                ASSERT_NEAR(double(drawn.points), asked, 0.501 + 1e-4 * asked) << per_meter;
                points |= drawn.points > 0;
                continue;
            }
            const double of_one = double(projected_length_px(part, view, ProjectionMode::measured)) / 5000.0;
            ASSERT_NEAR(double(drawn.lines) * of_one, asked, of_one + 1e-4 * asked) << per_meter;
            lines = true;
        }
    }
    EXPECT_TRUE(points && lines);
}

TEST(PointDemand, DensityIsTheInverseOfCount) {
    Random random(3);
    for (int round = 0; round < 100; ++round) {
        HandPlant plant;
        PackedPart& part =
            round % 2 ? plant.add_points(3000, random.next_in(0.001f, 50.0f))
                      : plant.add_lines(std::vector<float>(3000, 1.0f), random.next_in(0.001f, 50.0f));
        roughen_gains(part, random);
        const PointDemand demand(part);
        for (double count = 1e-3; count < 1e5; count *= 1.17)
            ASSERT_NEAR(demand.count(demand.density(count)), count, 2e-6 * count) << "round " << round;
    }
}

TEST(PointDemand, NeverFallsForAnyGains) {
    Random random(4);
    for (int round = 0; round < 200; ++round) {
        HandPlant plant;
        PackedPart& part =
            round % 2 ? plant.add_points(100, 1.0f) : plant.add_lines(std::vector<float>(100, 1.0f), 1.0f);
        for (float& gain : part.coverage_gain) gain = portable_exp2(random.next_around(0.0f, 60.0f));
        const PointDemand demand(part);
        double before = 0.0;
        for (double count = 1e-12; count < 1e12; count *= 1.5) {
            const double density = demand.density(count);
            ASSERT_TRUE(std::isfinite(density) && density > 0.0);
            ASSERT_GE(density, before * (1.0 - 1e-12));
            before = density;
        }
    }
}

TEST(PointDemand, WhatHasNothingToGiveAsksForNothing) {
    HandPlant plant;
    plant.add_points(10, 0.0f);
    EXPECT_EQ(PointDemand(plant.parts()[0]).area_m2(), 0.0);
    plant.add_points(10, 1.0f).triangle_count = 0;
    EXPECT_EQ(PointDemand(plant.parts()[1]).area_m2(), 0.0);
    plant.add_points(0, 1.0f);
    EXPECT_EQ(PointDemand(plant.parts()[2]).stored_count(), 0u);
    EXPECT_NEAR(PointDemand(plant.parts()[2]).area_m2(), 1.0, 1e-5);
    plant.add_lines({1.0f, 1.0f}, 1.0f).line_length_m = 0.0f;
    EXPECT_EQ(PointDemand(plant.parts()[3]).stored_count(), 0u);
    plant.add_points(10, 1.0f).area_m2 = INFINITY;
    EXPECT_EQ(PointDemand(plant.parts()[4]).area_m2(), 0.0) << "not finite";
}

}  // namespace
}  // namespace coppice
