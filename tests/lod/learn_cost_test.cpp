#include "plugins/vegetation/lod/learn_cost.h"

#include <gtest/gtest.h>
#include <bit>
#include <cmath>
#include <limits>
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_inf = std::numeric_limits<double>::infinity();

constexpr PrimitiveCosts k_machine{4.0, 60.0, 90.0, 15.0};

// Frames of a flight: each kind comes and goes.
PrimitiveCounts frame_of_flight(Random& random) {
    return {uint64_t(random.next_in(0.0f, 4.0e5f)), uint64_t(random.next_in(0.0f, 2.0e5f)),
            uint64_t(random.next_in(0.0f, 1.5e6f))};
}

// Roughly normal, of mean 1.
double noise(Random& random, float share) {
    float sum = 0.0f;
    for (int i = 0; i < 12; ++i) sum += random.next_unit() - 0.5f;
    return 1.0 + double(share * sum);
}

void expect_costs(const PrimitiveCosts& learned, const PrimitiveCosts& real, double within) {
    EXPECT_NEAR(learned.frame_ms, real.frame_ms, within * real.frame_ms);
    EXPECT_NEAR(learned.triangle_ns, real.triangle_ns, within * real.triangle_ns);
    EXPECT_NEAR(learned.line_ns, real.line_ns, within * real.line_ns);
    EXPECT_NEAR(learned.point_ns, real.point_ns, within * real.point_ns);
}

TEST(LearnedCost, FindsTheCostOfEachKind) {
    for (uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        LearnedCost cost;
        for (int frame = 0; frame < 400; ++frame) {
            const PrimitiveCounts counts = frame_of_flight(random);
            cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.02f));
        }
        expect_costs(cost.costs(), k_machine, 0.05);
    }
}

// Far from the usual: a GPU a thousand times as fast, a machine a hundred times as slow, kinds that cost next to nothing.
TEST(LearnedCost, FindsTheCostsOfAnyMachine) {
    const PrimitiveCosts machines[] = {{0.01, 0.03, 0.02, 0.015},
                                       {900.0, 2500.0, 9000.0, 600.0},
                                       {0.5, 10.0, 1.0, 20.0},
                                       {20.0, 5.0, 5.0, 5.0}};
    for (const PrimitiveCosts& machine : machines) {
        Random random(7);
        LearnedCost cost;
        for (int frame = 0; frame < 600; ++frame) {
            const PrimitiveCounts counts = frame_of_flight(random);
            cost.learn(counts, machine.ms_of(counts) * noise(random, 0.01f));
        }
        const PrimitiveCosts learned = cost.costs();
        double off = 0.0;
        for (int frame = 0; frame < 100; ++frame) {
            const PrimitiveCounts counts = frame_of_flight(random);
            off += std::fabs(learned.ms_of(counts) / machine.ms_of(counts) - 1.0) / 100.0;
        }
        EXPECT_LT(off, 0.01) << machine.frame_ms;
        // What weighs in a frame is known by itself.
        if (machine.frame_ms < 1.0 && machine.line_ns >= 0.02) {
            EXPECT_NEAR(learned.point_ns, machine.point_ns, 0.05 * machine.point_ns);
        }
    }
}

// A free kind must not become one that gives time back.
TEST(LearnedCost, CostsAreNeverNegative) {
    const PrimitiveCosts machine{5.0, 40.0, 0.0, 20.0};
    Random random(3);
    LearnedCost cost;
    for (int frame = 0; frame < 1000; ++frame) {
        const PrimitiveCounts counts = frame_of_flight(random);
        cost.learn(counts, machine.ms_of(counts) * noise(random, 0.05f));
        ASSERT_GE(cost.costs().frame_ms, 0.0);
        ASSERT_GE(cost.costs().triangle_ns, 0.0);
        ASSERT_GE(cost.costs().line_ns, 0.0);
        ASSERT_GE(cost.costs().point_ns, 0.0);
    }
    EXPECT_LT(cost.costs().line_ns, 4.0);
    EXPECT_NEAR(cost.costs().point_ns, 20.0, 2.0);
    EXPECT_NEAR(cost.costs().triangle_ns, 40.0, 4.0);
}

// The first frame compiles shaders; now and then the system takes the machine away.
TEST(LearnedCost, HitchesDoNotSpoilIt) {
    for (uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed);
        LearnedCost cost;
        for (int frame = 0; frame < 500; ++frame) {
            const PrimitiveCounts counts = frame_of_flight(random);
            const bool hitch = frame == 0 || frame % 40 == 39;
            cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.02f) * (hitch ? 10.0 : 1.0));
        }
        expect_costs(cost.costs(), k_machine, 0.08);
    }
}

TEST(LearnedCost, OneHitchMovesTheBudgetByAPercent) {
    Random random(5);
    LearnedCost cost;
    const PrimitiveCounts counts{200'000, 50'000, 800'000};
    for (int frame = 0; frame < 200; ++frame)
        cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.03f));
    const double before = double(cost.vertex_budget_for(33.0, counts));
    cost.learn(counts, 2000.0);
    EXPECT_NEAR(double(cost.vertex_budget_for(33.0, counts)), before, 0.01 * before);
}

// The window grew, the laptop left its charger.
TEST(LearnedCost, FollowsWhatLasts) {
    for (double slower : {4.0, 1.5, 0.3}) {
        Random random(6);
        LearnedCost cost;
        const PrimitiveCounts counts{200'000, 50'000, 800'000};
        for (int frame = 0; frame < 200; ++frame)
            cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.03f));
        for (int frame = 0; frame < 40; ++frame)
            cost.learn(counts, slower * k_machine.ms_of(counts) * noise(random, 0.03f));
        EXPECT_NEAR(cost.costs().ms_of(counts), slower * k_machine.ms_of(counts),
                    0.05 * slower * k_machine.ms_of(counts));
    }
}

TEST(LearnedCost, OneFrameSaysHowFastTheMachineIs) {
    LearnedCost cost;
    const PrimitiveCounts counts{200'000, 50'000, 800'000};
    cost.learn(counts, 2.0);
    EXPECT_NEAR(cost.costs().ms_of(counts), 2.0, 1e-9);
    const uint64_t vertices = 3 * counts.triangles + 2 * counts.lines + counts.points;
    EXPECT_NEAR(double(cost.vertex_budget_for(2.0, counts)), double(vertices), 1.0);
}

// A view at rest tells one thing a hundred thousand times over: nothing may grow without bound, and a cut to another view
// must still find costs as they were learned in the flight before.
TEST(LearnedCost, AViewAtRestNeitherBlowsUpNorForgets) {
    Random random(8);
    LearnedCost cost;
    for (int frame = 0; frame < 400; ++frame) {
        const PrimitiveCounts counts = frame_of_flight(random);
        cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.02f));
    }
    const PrimitiveCounts rest{10'000, 1'000, 900'000};
    for (int frame = 0; frame < 100'000; ++frame)
        cost.learn(rest, k_machine.ms_of(rest) * noise(random, 0.02f));
    EXPECT_NEAR(cost.costs().ms_of(rest), k_machine.ms_of(rest), 0.01 * k_machine.ms_of(rest));
    const PrimitiveCounts near{400'000, 100'000, 50'000};
    EXPECT_NEAR(cost.costs().ms_of(near), k_machine.ms_of(near), 0.1 * k_machine.ms_of(near));
}

TEST(LearnedCost, ConstantFramesAloneGiveTheirTime) {
    LearnedCost cost;
    const PrimitiveCounts counts{200'000, 50'000, 800'000};
    for (int frame = 0; frame < 10'000; ++frame) cost.learn(counts, 20.0);
    EXPECT_NEAR(cost.costs().ms_of(counts), 20.0, 1e-6);
    // And then one kind alone.
    for (int frame = 0; frame < 60; ++frame) cost.learn({0, 0, 3'000'000}, 50.0);
    EXPECT_NEAR(cost.costs().ms_of({0, 0, 3'000'000}), 50.0, 0.5);
}

TEST(LearnedCost, EmptyFramesTellTheFramesOwnCost) {
    LearnedCost cost;
    for (int frame = 0; frame < 100; ++frame) cost.learn({}, 3.0);
    EXPECT_NEAR(cost.costs().frame_ms, 3.0, 1e-6);
    EXPECT_GT(cost.vertex_budget_for(5.0, {}), 0u);
    EXPECT_EQ(cost.vertex_budget_for(3.0, {}), 0u);
}

TEST(LearnedCost, BrokenTimesAreIgnored) {
    Random random(9);
    LearnedCost cost, clean;
    for (int frame = 0; frame < 100; ++frame) {
        const PrimitiveCounts counts = frame_of_flight(random);
        const double ms = k_machine.ms_of(counts) * noise(random, 0.02f);
        for (double broken : {k_nan, k_inf, -k_inf, -1.0, 0.0}) cost.learn(counts, broken);
        cost.learn(counts, ms);
        clean.learn(counts, ms);
    }
    EXPECT_EQ(cost.costs().point_ns, clean.costs().point_ns);
    EXPECT_EQ(cost.costs().frame_ms, clean.costs().frame_ms);
}

TEST(LearnedCost, AbsurdFramesLeaveNumbers) {
    Random random(10);
    LearnedCost cost;
    const double times[] = {1.0e-300, 1.0e300, 1.0, 1.0e-9, 1.0e9};
    const uint64_t counts[] = {0, 1, UINT64_MAX, 1'000'000};
    for (int frame = 0; frame < 20'000; ++frame) {
        cost.learn({counts[random.next_below(4)], counts[random.next_below(4)], counts[random.next_below(4)]},
                   times[random.next_below(5)]);
        const PrimitiveCosts learned = cost.costs();
        for (double value : {learned.frame_ms, learned.triangle_ns, learned.line_ns, learned.point_ns})
            ASSERT_TRUE(std::isfinite(value) && value >= 0.0) << frame;
        ASSERT_LE(cost.vertex_budget_for(1.0e300, {UINT64_MAX, 0, 1}), uint64_t(1) << 40);
    }
    // It recovers.
    for (int frame = 0; frame < 1000; ++frame) {
        const PrimitiveCounts flight = frame_of_flight(random);
        cost.learn(flight, k_machine.ms_of(flight) * noise(random, 0.01f));
    }
    const PrimitiveCounts view{200'000, 50'000, 800'000};
    EXPECT_NEAR(cost.costs().ms_of(view), k_machine.ms_of(view), 0.05 * k_machine.ms_of(view));
}

// The same budget from every compiler, and so the same picture in a test that plays recorded times.
TEST(LearnedCost, SameBitsFromAnyCompiler) {
    Random random(13);
    LearnedCost cost;
    for (int frame = 0; frame < 300; ++frame) {
        const PrimitiveCounts counts = frame_of_flight(random);
        cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.05f));
    }
    EXPECT_EQ(std::bit_cast<uint64_t>(cost.costs().point_ns), 4624602048079914832u) << cost.costs().point_ns;
    EXPECT_EQ(cost.vertex_budget_for(25.0, {200'000, 50'000, 800'000}), 1102722u);
}

TEST(LearnedCost, BudgetIsWhatTakesTheTime) {
    Random random(11);
    LearnedCost cost;
    for (int frame = 0; frame < 400; ++frame) {
        const PrimitiveCounts counts = frame_of_flight(random);
        cost.learn(counts, k_machine.ms_of(counts) * noise(random, 0.02f));
    }
    for (const PrimitiveCounts& mix : {PrimitiveCounts{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3, 2, 50}}) {
        const double parts = 3.0 * double(mix.triangles) + 2.0 * double(mix.lines) + double(mix.points);
        const double times = double(cost.vertex_budget_for(30.0, mix)) / parts;
        const PrimitiveCounts drawn{uint64_t(times * double(mix.triangles)),
                                    uint64_t(times * double(mix.lines)),
                                    uint64_t(times * double(mix.points))};
        EXPECT_NEAR(k_machine.ms_of(drawn), 30.0, 0.05 * 30.0);
    }
    // Of an unknown mix, no more than any kind may have.
    const uint64_t of_any = cost.vertex_budget_for(30.0, {});
    for (const PrimitiveCounts& mix : {PrimitiveCounts{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
        EXPECT_LE(of_any, cost.vertex_budget_for(30.0, mix));
    EXPECT_GT(of_any, 0u);
    EXPECT_EQ(cost.vertex_budget_for(0.0, {}), 0u);
    EXPECT_EQ(cost.vertex_budget_for(-5.0, {}), 0u);
    EXPECT_EQ(cost.vertex_budget_for(k_nan, {}), 0u);
    EXPECT_EQ(cost.vertex_budget_for(k_inf, {0, 0, 1}), uint64_t(1) << 40);
}

// Times follow the budget and the budget the times: it settles on the time asked for.
TEST(LearnedCost, ABudgetOfTimeIsHeld) {
    Random random(12);
    LearnedCost cost;
    PrimitiveCounts mix{0, 0, 1};
    int held = 0;
    for (int frame = 0; frame < 300; ++frame) {
        if (frame % 60 == 0) mix = frame_of_flight(random);  // a camera cut
        const double parts = 3.0 * double(mix.triangles) + 2.0 * double(mix.lines) + double(mix.points);
        const double times = double(cost.vertex_budget_for(25.0, mix)) / parts;
        const PrimitiveCounts drawn{uint64_t(times * double(mix.triangles)),
                                    uint64_t(times * double(mix.lines)),
                                    uint64_t(times * double(mix.points))};
        const double ms = k_machine.ms_of(drawn) * noise(random, 0.02f);
        cost.learn(drawn, ms);
        if (frame >= 10) held += std::fabs(k_machine.ms_of(drawn) - 25.0) < 0.05 * 25.0;
    }
    EXPECT_GE(held, 270);
}

}  // namespace
}  // namespace coppice
