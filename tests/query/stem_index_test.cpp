// Against every stem tested one by one, by a step of a hundredth of a millimetre where geometry is in doubt.
#include "plugins/vegetation/query/stem_index.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include "runtime/core/random.h"

namespace coppice {
namespace {

double distance_to_axis(const Stem& stem, dvec3 at) {
    const dvec3 axis = stem.head_world - stem.foot_world, from = at - stem.foot_world;
    const double square = glm::dot(axis, axis);
    const double share = square > 0.0 ? glm::clamp(glm::dot(axis, from) / square, 0.0, 1.0) : 0.0;
    return glm::length(from - axis * share);
}

// Sphere tracing: steps as long as the way to the nearest surface, which nothing can be missed by.
double trace(const Stem& stem, dvec3 from, dvec3 along, double most_m) {
    double at = 0.0;
    for (int step = 0; step < 100000 && at <= most_m; ++step) {
        const double away = distance_to_axis(stem, from + along * at) - double(stem.radius_m);
        if (away < 1e-6) return at;
        at += away;
    }
    return INFINITY;
}

struct Forest {
    std::vector<Stem> stems;
    Random random{7};
    double number(double least, double most) { return least + (most - least) * double(random.next_unit()); }
    Stem stem(uint32_t plant, double extent_m) {
        const dvec3 foot(number(-extent_m, extent_m) + 500.0, number(-3, 3),
                         number(-extent_m, extent_m) - 200.0);
        return {foot, foot + dvec3(number(-2, 2), number(0, 20), number(-2, 2)), float(number(0.02, 0.8)),
                plant};
    }
    explicit Forest(uint32_t count, double extent_m = 60.0) {
        for (uint32_t i = 0; i < count; ++i) stems.push_back(stem(i * 3 + 1, extent_m));
    }
    dvec3 place(double extent_m) {
        return {number(-extent_m, extent_m) + 500.0, number(-4, 25), number(-extent_m, extent_m) - 200.0};
    }
    vec3 direction() {
        const int axis = int(random.next_below(8));
        if (axis < 3) {  // straight along an axis of the grid, up or down too
            vec3 straight(0.0f);
            straight[axis] = random.next_below(2) ? 1.0f : -1.0f;
            return straight;
        }
        return vec3(float(number(-1, 1)), float(number(-0.5, 0.5)), float(number(-1, 1))) + vec3(1e-3f);
    }
};

void expect_like_brute_force(const StemIndex& index, std::span<const Stem> stems, Forest& forest, int count) {
    int hits = 0;
    for (int i = 0; i < count; ++i) {
        const dvec3 from = forest.place(90.0);
        const vec3 direction = forest.direction();
        const dvec3 along = dvec3(direction) / glm::length(dvec3(direction));
        const double most_m = forest.number(0.0, 150.0);
        double expected = INFINITY;
        std::map<uint32_t, double> at;
        for (const Stem& stem : stems) {
            const double distance = trace(stem, from, along, std::min(most_m, expected + 1.0));
            at[stem.plant] = distance;
            if (distance <= most_m) expected = std::min(expected, distance);
        }
        const StemHit hit = index.first_hit(from, direction, float(most_m));
        if (std::fabs(expected - most_m) < 1e-2) continue;  // at the very end of the ray
        if (!hit.any()) {
            // A ray may graze a stem within what numbers resolve.
            if (expected < INFINITY) {
                double closest = INFINITY;
                for (const Stem& stem : stems)
                    for (double s = expected - 0.5; s < expected + 0.5; s += 0.002)
                        closest = std::min(closest,
                                           distance_to_axis(stem, from + along * s) - double(stem.radius_m));
                ASSERT_GT(closest, -2e-3) << "ray " << i << " missed what lies at " << expected << " m";
            }
            continue;
        }
        ++hits;
        ASSERT_NEAR(double(hit.distance_m), expected, 2e-2) << "ray " << i;
        ASSERT_NEAR(at[hit.plant], expected, 2e-2) << "ray " << i;
        ASSERT_NEAR(glm::length(hit.normal_world), 1.0f, 1e-4f);
        if (hit.distance_m > 0.0f) {
            ASSERT_LT(glm::dot(hit.normal_world, vec3(along)), 0.05f) << "ray " << i;
        }
    }
    EXPECT_GE(hits, count / 20) << "too few rays meet anything to say something";
}

void expect_nearest(const StemIndex& index, std::span<const Stem> stems, Forest& forest, int count) {
    for (int i = 0; i < count; ++i) {
        const dvec3 at = forest.place(120.0);
        const float within_m = float(forest.number(0.0, 40.0));
        double expected = INFINITY;
        for (const Stem& stem : stems)
            expected = std::min(expected, std::max(distance_to_axis(stem, at) - double(stem.radius_m), 0.0));
        const StemHit hit = index.nearest(at, within_m);
        if (std::fabs(expected - double(within_m)) < 1e-3) continue;
        ASSERT_EQ(hit.any(), expected <= double(within_m)) << "place " << i;
        if (hit.any()) {
            ASSERT_NEAR(double(hit.distance_m), expected, 1e-3) << "place " << i;
        }
    }
}

void expect_boxes(const StemIndex& index, std::span<const Stem> stems, Forest& forest, int count) {
    for (int i = 0; i < count; ++i) {
        const dvec3 a = forest.place(90.0), b = forest.place(90.0);
        const dvec3 least = glm::min(a, b), most = glm::max(a, b);
        std::vector<Stem> found;
        index.in_box(least, most, found);
        std::map<uint32_t, int> times;
        for (const Stem& stem : found) ++times[stem.plant];
        for (const Stem& stem : stems) {
            const dvec3 low = glm::min(stem.foot_world, stem.head_world) - double(stem.radius_m),
                        high = glm::max(stem.foot_world, stem.head_world) + double(stem.radius_m);
            double margin = INFINITY;  // by how much they touch; negative: they do not
            for (int axis = 0; axis < 3; ++axis)
                margin = std::min({margin, most[axis] - low[axis], high[axis] - least[axis]});
            if (std::fabs(margin) < 1e-3) continue;
            ASSERT_EQ(times[stem.plant], margin > 0.0 ? 1 : 0) << "box " << i << ", plant " << stem.plant;
        }
    }
}

}  // namespace

TEST(StemIndex, RaysPlacesAndBoxesFindWhatAllStemsSay) {
    Forest forest(700);
    const StemIndex index(forest.stems);
    EXPECT_EQ(index.size(), 700u);
    expect_like_brute_force(index, forest.stems, forest, 300);
    expect_nearest(index, forest.stems, forest, 1000);
    expect_boxes(index, forest.stems, forest, 100);
}

TEST(StemIndex, FewOrStrangeStems) {
    for (uint32_t count : {1u, 2u, 5u}) {
        Forest forest(count, 3.0);
        const StemIndex index(forest.stems);
        expect_nearest(index, forest.stems, forest, 100);
        expect_boxes(index, forest.stems, forest, 50);
    }
    // All in one place, a ball, one that lies, one as wide as all others stand apart.
    std::vector<Stem> stems;
    for (uint32_t i = 0; i < 50; ++i) stems.push_back({dvec3(500, 0, -200), dvec3(500, 9, -200), 0.3f, i});
    stems.push_back({dvec3(520, 1, -200), dvec3(520, 1, -200), 2.0f, 50});
    stems.push_back({dvec3(480, 1, -210), dvec3(480, 1, -190), 0.4f, 51});
    stems.push_back({dvec3(500, 0, -150), dvec3(500, 5, -150), 30.0f, 52});
    Forest forest(1);
    const StemIndex index(stems);
    expect_like_brute_force(index, stems, forest, 300);
    expect_nearest(index, stems, forest, 300);
    expect_boxes(index, stems, forest, 50);
}

TEST(StemIndex, EditsAreAsIfItHadBeenBuiltSo) {
    Forest forest(400);
    StemIndex index(forest.stems);
    std::map<uint32_t, Stem> now;
    for (const Stem& stem : forest.stems) now[stem.plant] = stem;
    for (int round = 0; round < 4; ++round) {
        for (int edit = 0; edit < 120; ++edit) {
            const uint32_t plant = uint32_t(forest.random.next_below(1400));
            if (forest.random.next_below(3) == 0) {
                index.remove(plant);
                now.erase(plant);
            } else {
                // Some far beside all others.
                const Stem stem = forest.stem(plant, forest.random.next_below(8) ? 60.0 : 85.0);
                index.set(stem);
                now[plant] = stem;
            }
        }
        std::vector<Stem> stems;
        for (const auto& [plant, stem] : now) stems.push_back(stem);
        ASSERT_EQ(index.size(), stems.size());
        expect_like_brute_force(index, stems, forest, 60);
        expect_nearest(index, stems, forest, 200);
        expect_boxes(index, stems, forest, 20);
    }
    for (const auto& [plant, stem] : now) index.remove(plant);
    EXPECT_EQ(index.size(), 0u);
    EXPECT_FALSE(index.first_hit(dvec3(500, 2, -400), vec3(0, 0, 1), 1000.0f).any());
    EXPECT_FALSE(index.nearest(dvec3(500, 2, -200), 1000.0f).any());
}

TEST(StemIndex, LongWaysLoseNoThinStem) {
    // Ten centimetres wide, a kilometre and ten away, of two that stand 20 km apart.
    const std::vector<Stem> stems{{dvec3(0, 0, 0), dvec3(0, 10, 0), 0.05f, 1},
                                  {dvec3(20000, 0, 0), dvec3(20000, 10, 0), 0.05f, 2}};
    const StemIndex index(stems);
    for (double away : {1000.0, 10000.0}) {
        const StemHit hit = index.first_hit(dvec3(0.04, 5, -away), vec3(0, 0, 1), 20000.0f);
        EXPECT_EQ(hit.plant, 1u) << away;
        EXPECT_NEAR(hit.distance_m, float(away - 0.03), 0.02f);
        EXPECT_FALSE(index.first_hit(dvec3(0.06, 5, -away), vec3(0, 0, 1), 20000.0f).any()) << away;
    }
    EXPECT_EQ(index.first_hit(dvec3(-10000, 5, 0), vec3(1, 0, 0), 40000.0f).plant, 1u);
    EXPECT_EQ(index.first_hit(dvec3(100, 5, 0), vec3(1, 0, 0), 40000.0f).plant, 2u);
}

TEST(StemIndex, NonsenseHasAnAnswer) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Stem> stems{{dvec3(0, 0, 0), dvec3(0, 4, 0), 0.2f, 1},
                            {dvec3(double(nan)), dvec3(0), 0.2f, 2},
                            {dvec3(0), dvec3(0, INFINITY, 0), 0.2f, 3},
                            {dvec3(1), dvec3(2), nan, 4},
                            {dvec3(1), dvec3(2), 0.0f, 5},
                            {dvec3(1), dvec3(2), -1.0f, 6}};
    StemIndex index(stems);
    EXPECT_EQ(index.size(), 1u);
    EXPECT_FALSE(index.first_hit(dvec3(double(nan)), vec3(1, 0, 0), 10.0f).any());
    EXPECT_FALSE(index.first_hit(dvec3(0, 0, 5), vec3(0), 10.0f).any());
    EXPECT_FALSE(index.first_hit(dvec3(0, 0, 5), vec3(nan, 0, -1), 10.0f).any());
    EXPECT_FALSE(index.first_hit(dvec3(0, 1, 5), vec3(0, 0, -1), nan).any());
    EXPECT_TRUE(index.first_hit(dvec3(0, 1, 5), vec3(0, 0, -1e20f), INFINITY).any());
    EXPECT_FALSE(index.nearest(dvec3(double(nan)), 10.0f).any());
    EXPECT_TRUE(index.nearest(dvec3(0, 1, 1e6), INFINITY).any());
    std::vector<Stem> found;
    index.in_box(dvec3(1), dvec3(-1), found);
    EXPECT_TRUE(found.empty());
    index.remove(99);
    index.set({dvec3(double(nan)), dvec3(0), 1.0f, 1});
    EXPECT_EQ(index.size(), 0u);
    StemIndex none;
    EXPECT_FALSE(none.first_hit(dvec3(0), vec3(1, 0, 0), 1.0f).any());
    none.set(stems[0]);
    EXPECT_EQ(none.first_hit(dvec3(0, 1, 5), vec3(0, 0, -1), 10.0f).plant, 1u);
}

}  // namespace coppice
