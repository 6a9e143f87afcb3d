// What is dropped is made up for by what stays, at every distance.
#include "plugins/vegetation/lod/drop_resize.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <vector>
#include "runtime/core/math.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

TEST(DropResize, TheShareFallsWithTheSquareOfTheDistance) {
    const DropLaw law{20.0f, 0.01f};
    EXPECT_EQ(remaining_share(0.0f, law), 1.0f);
    EXPECT_EQ(remaining_share(-5.0f, law), 1.0f);
    EXPECT_EQ(remaining_share(20.0f, law), 1.0f);
    EXPECT_FLOAT_EQ(remaining_share(40.0f, law), 0.25f);
    EXPECT_FLOAT_EQ(remaining_share(100.0f, law), 0.04f);
    EXPECT_FLOAT_EQ(remaining_share(1000.0f, law), 0.01f) << "the least";
    EXPECT_FLOAT_EQ(remaining_share(INFINITY, law), 0.01f);
    EXPECT_EQ(remaining_share(NAN, law), 1.0f);
}

TEST(DropResize, GrowthByWeightIsThePapers) {
    // Eq. 10.3 with n / k = 25.
    EXPECT_FLOAT_EQ(weighted_growth(0.04f, 1.0f), 5.0f);
    EXPECT_FLOAT_EQ(weighted_growth(0.04f, 0.5f), 3.0f);
    EXPECT_FLOAT_EQ(weighted_growth(0.04f, 0.0f), 1.0f);
    EXPECT_FLOAT_EQ(weighted_growth(1.0f, 0.7f), 1.0f);
}

TEST(DropResize, TolerantGrowthCoversWhatItPromises) {
    for (float depth : {0.01f, 0.3f, 1.0f, 3.0f, 8.0f})
        for (float tolerance : {0.0f, 0.02f, 0.1f})
            for (float share : {0.9f, 0.5f, 0.1f, 0.01f}) {
                const float growth = tolerant_area_growth(share, depth, tolerance);
                EXPECT_GE(growth, 1.0f);
                EXPECT_LE(growth, 1.0f / share * 1.0001f);
                if (growth == 1.0f) continue;
                const float wanted = (1.0f - tolerance) * (1.0f - std::exp(-depth));
                EXPECT_NEAR(1.0f - std::exp(-share * growth * depth), wanted, 2e-4f)
                    << "depth " << depth << ", tolerance " << tolerance << ", share " << share;
            }
    EXPECT_FLOAT_EQ(tolerant_area_growth(0.1f, 2.0f, 0.0f), 10.0f) << "without tolerance the area stays";
    EXPECT_FLOAT_EQ(tolerant_area_growth(0.1f, 0.0f, 0.1f), 9.0f) << "where nothing hides anything";
    EXPECT_FLOAT_EQ(tolerant_area_growth(0.1f, 1e9f, 0.0f), 10.0f) << "nor can the sky be seen at all";
    // A dense crown: 2 % less seen of it, and a half of the area will do.
    EXPECT_LT(tolerant_area_growth(0.1f, 8.0f, 0.02f), 5.0f);
}

TEST(DropResize, FadingKeepsTheAreaAtEveryShare) {
    constexpr int k_items = 4000;
    for (float band : {0.0f, 0.1f, 0.5f, 1.0f})
        for (float share = 0.003f; share <= 1.0f; share += 0.0371f) {
            double sum = 0.0;
            for (int i = 0; i < k_items; ++i)
                sum += double(remaining_area((float(i) + 0.5f) / k_items, share, band));
            EXPECT_NEAR(sum / k_items, share, 0.5 / k_items) << "band " << band;
        }
    EXPECT_EQ(remaining_area(0.999f, 1.0f, 0.5f), 1.0f) << "at first all are whole";
}

TEST(DropResize, WhatIsDroppedStaysDroppedAndNothingPops) {
    const DropLaw law{10.0f, 0.02f};
    constexpr float k_band = 0.3f, k_step = 1.01f;
    for (float place : {0.0f, 0.01f, 0.2f, 0.5f, 0.9f, 0.999f}) {
        float before = 1.0f;
        for (float distance_m = 1.0f; distance_m < 500.0f; distance_m *= k_step) {
            const float now = remaining_area(place, remaining_share(distance_m, law), k_band);
            EXPECT_LE(now, before) << "place " << place << " at " << distance_m << " m";
            // A step of 1 % of the distance is 2 % of the share, of which the band takes 2 * 0.3; near the share of one it is
            // narrower.
            if (place < 0.7f) {
                EXPECT_GE(now, before - 0.08f) << "place " << place << " at " << distance_m << " m";
            }
            before = now;
        }
    }
    EXPECT_EQ(remaining_area(0.01f, 0.02f, k_band), 1.0f) << "the least stay for ever";
}

TEST(DropResize, ContrastFallsWithTheRootOfTheShare) {
    EXPECT_FLOAT_EQ(remaining_contrast(1.0f), 1.0f);
    EXPECT_FLOAT_EQ(remaining_contrast(0.25f), 0.5f);
    // What it is for: the mean of n values and that of k with less contrast spread as much.
    Random random(3);
    constexpr int k_all = 64, k_few = 4, k_trials = 4000;
    const float contrast = remaining_contrast(float(k_few) / k_all);
    double of_all = 0.0, of_few = 0.0;
    for (int trial = 0; trial < k_trials; ++trial) {
        double all = 0.0, few = 0.0;
        for (int i = 0; i < k_all; ++i) all += double(random.next_in(-1, 1)) / k_all;
        for (int i = 0; i < k_few; ++i) few += double(contrast * random.next_in(-1, 1)) / k_few;
        of_all += all * all;
        of_few += few * few;
    }
    EXPECT_NEAR(of_few / of_all, 1.0, 0.1);
}

TEST(DropResize, PointsTakeOverWhereTheyAreFewer) {
    // 50 m2 of leaves at 100 m with a focal length of 600 px: 25 m2 seen, 900 px2; with d' = 3 px 100 points.
    EXPECT_FLOAT_EQ(points_from_m(50.0f, 100.0f, 600.0f, 3.0f), 100.0f);
    EXPECT_FLOAT_EQ(points_from_m(50.0f, 25.0f, 600.0f, 3.0f), 200.0f);
    EXPECT_EQ(points_from_m(0.0f, 100.0f, 600.0f, 3.0f), 0.0f);
}

// Morton order of squares of about a metre.
uint32_t along_curve(vec2 at) {
    uint32_t code = 0;
    const auto x = uint32_t(at.x + 1024.0f), y = uint32_t(at.y + 1024.0f);
    for (uint32_t bit = 0; bit < 11; ++bit)
        code |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
    return code;
}

// Fig. 10.10: a forest of 13,500 billboards that is shown with 4,500, on an open field about the viewer.
constexpr int k_billboards = 13'500;
constexpr float k_far_m = 600.0f, k_band = 0.2f;

// As scenes keep them: along a curve, so that neighbours in the list are neighbours on the ground.
std::vector<vec2> made_forest(uint64_t seed) {
    std::vector<vec2> forest;
    Random random(seed);
    while (forest.size() < k_billboards) {
        const vec2 at(random.next_in(-k_far_m, k_far_m), random.next_in(-k_far_m, k_far_m));
        if (glm::length(at) < k_far_m) forest.push_back(at);
    }
    std::sort(forest.begin(), forest.end(), [](vec2 a, vec2 b) { return along_curve(a) < along_curve(b); });
    return forest;
}

struct Shown {
    int billboards = 0;             // of which something is drawn
    std::vector<double> ring_area;  // over that of all billboards there; rings of equal area
};
Shown show(const std::vector<vec2>& forest, int ring_count) {
    // Each ring has as many. Of those beyond r_1 = r_0 sqrt(1 + band) something is drawn of r_1^2 / r^2: in all
    // (r_1 / R)^2 (1 + 2 ln(R / r_1)), which is a third where R / r_1 = 3.14.
    const DropLaw law{k_far_m / (3.14f * std::sqrt(1.0f + k_band)), 0.01f};
    std::vector<double> all(size_t(ring_count), 0.0), drawn(all);
    Shown shown;
    for (size_t i = 0; i < forest.size(); ++i) {
        // Golden section: of any stretch of the list as many stay as of any other.
        const double turns = double(i) * 0.6180339887498949;
        const float distance_m = glm::length(forest[i]), share = remaining_share(distance_m, law);
        const float area = remaining_area(float(turns - std::floor(turns)), share, k_band);
        const float growth = weighted_growth(share, 1.0f);
        const size_t ring = size_t(float(ring_count) * distance_m * distance_m / (k_far_m * k_far_m));
        all[ring] += 1.0;
        drawn[ring] += double(growth * growth * area);
        shown.billboards += area > 0.0f;
    }
    for (size_t ring = 0; ring < all.size(); ++ring) shown.ring_area.push_back(drawn[ring] / all[ring]);
    return shown;
}

TEST(DropResize, AForestOfBillboardsKeepsItsAreaAtEveryDistance) {
    const Shown shown = show(made_forest(11), 4);
    EXPECT_NEAR(double(shown.billboards), 4500.0, 90.0);
    for (double area : shown.ring_area) EXPECT_NEAR(area, 1.0, 0.04);
    // In one forest a narrow ring has a few hundred billboards, and chance is left. In the mean over forests it is not.
    constexpr int k_rings = 12, k_forests = 24;
    std::vector<double> mean(k_rings, 0.0);
    for (int seed = 0; seed < k_forests; ++seed) {
        const Shown one = show(made_forest(uint64_t(100 + seed)), k_rings);
        for (size_t ring = 0; ring < k_rings; ++ring) mean[ring] += one.ring_area[ring] / k_forests;
    }
    for (double area : mean) EXPECT_NEAR(area, 1.0, 0.03);
}

}  // namespace
}  // namespace coppice
