#include "plugins/vegetation/lod/budget.h"

#include <gtest/gtest.h>
#include <limits>
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr float k_inf = std::numeric_limits<float>::infinity();
constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();
constexpr float k_least = k_finest_sample_distance_px, k_most = k_coarsest_sample_distance_px;

struct Points {
    float wanted, stored, most;
};
struct Lines {
    float wanted, triangles_below, most;
};
struct Parts {
    std::vector<Points> points;
    std::vector<Lines> lines;
};

// The laws of choose_part.h, a part at a time.
double vertices_of(const Points& part, double d) {
    const double p = double(part.wanted) / (d * d), n = part.stored;
    return p <= n ? p : n + (part.most - n) * std::min((p - n) / (0.5 * n), 1.0);
}
double vertices_of(const Lines& part, double d) {
    return d <= double(part.triangles_below) ? double(part.most) : double(part.wanted) / d;
}
double vertices_at(const Parts& parts, double d) {
    double sum = 0.0;
    for (const Points& part : parts.points) sum += vertices_of(part, d);
    for (const Lines& part : parts.lines) sum += vertices_of(part, d);
    return sum;
}

BudgetHistogram histogram_of(const Parts& parts) {
    BudgetHistogram histogram;
    for (const Points& part : parts.points) histogram.add_points(part.wanted, part.stored, part.most);
    for (const Lines& part : parts.lines) histogram.add_lines(part.wanted, part.triangles_below, part.most);
    return histogram;
}

// Log-uniform over some powers of ten.
float next_log(Random& random, float low_log10, float high_log10) {
    return std::pow(10.0f, random.next_in(low_log10, high_log10));
}

// Plants from a few to ten thousands of triangles, from far below a pixel to the whole screen.
Parts random_parts(Random& random, size_t count, float line_share) {
    Parts parts;
    for (size_t i = 0; i < count; ++i) {
        const float triangles = std::floor(next_log(random, 0.5f, 4.5f));
        const float last_level_px = next_log(random, -2.5f, 1.5f);
        if (random.next_unit() >= line_share) {
            parts.points.push_back(
                {last_level_px * last_level_px * 3.0f * triangles, 2.0f * triangles, 3.0f * triangles});
        } else {
            const float lines_at_jump = random.next_in(0.01f, 0.6f) * 3.0f * triangles;
            parts.lines.push_back({lines_at_jump * last_level_px, last_level_px, 3.0f * triangles});
        }
    }
    return parts;
}

double error_of(const Parts& parts, double budget, float d) {
    return std::fabs(vertices_at(parts, d) - budget) / budget;
}

TEST(SampleDistance, HoldsTheBudgetOfRandomPoints) {
    Random random(1);
    double worst = 0.0;
    for (int round = 0; round < 200; ++round) {
        const Parts parts = random_parts(random, size_t(next_log(random, 2.0f, 4.0f)), 0.0f);
        const BudgetHistogram histogram = histogram_of(parts);
        // Budgets from nearly nothing to nearly all.
        const uint64_t budget = uint64_t(vertices_at(parts, next_log(random, -0.9f, 2.7f)));
        if (budget == 0) continue;
        const float d = solve_sample_distance(histogram, 0, budget, k_least, k_most);
        worst = std::max(worst, error_of(parts, double(budget), d));
    }
    EXPECT_LT(worst, 0.001);
}

// The worst for a histogram: all parts become triangles within one bin, wherever it lies, and the budget is met there.
TEST(SampleDistance, HoldsTheBudgetWithinOneBin) {
    Random random(13);
    for (int round = 0; round < 300; ++round) {
        const float center_px2 = next_log(random, -1.7f, 5.3f);
        Parts parts;
        for (int i = 0; i < 100; ++i) {
            const float triangles = std::floor(next_log(random, 2.0f, 3.0f));
            const float last_level_px2 = center_px2 * random.next_in(0.998f, 1.002f);
            parts.points.push_back({last_level_px2 * 3.0f * triangles, 2.0f * triangles, 3.0f * triangles});
        }
        const BudgetHistogram histogram = histogram_of(parts);
        const double budget = std::floor(
            vertices_at(parts, std::sqrt(double(center_px2) * double(random.next_in(0.997f, 1.003f)))));
        const float d = solve_sample_distance(histogram, 0, uint64_t(budget), k_least, k_most);
        EXPECT_LT(error_of(parts, budget, d), 0.001) << center_px2;
    }
}

TEST(SampleDistance, HoldsTheBudgetOfAHundredThousandParts) {
    Random random(2);
    const Parts parts = random_parts(random, 100'000, 0.3f);
    const BudgetHistogram histogram = histogram_of(parts);
    for (float at_px : {0.2f, 0.5f, 1.0f, 3.0f, 20.0f, 200.0f}) {
        const uint64_t budget = uint64_t(vertices_at(parts, at_px));
        const float d = solve_sample_distance(histogram, 0, budget, k_least, k_most);
        EXPECT_LE(error_of(parts, double(budget), d), 0.005) << at_px;
    }
}

// Within 0.5 %, or below the budget with a jump across it a bin finer.
TEST(SampleDistance, StaysBelowJumpsOfLines) {
    Random random(3);
    int exact = 0, jumps = 0;
    for (int round = 0; round < 400; ++round) {
        const Parts parts =
            random_parts(random, size_t(next_log(random, 0.3f, 4.0f)), random.next_in(0.2f, 1.0f));
        const BudgetHistogram histogram = histogram_of(parts);
        const uint64_t budget =
            uint64_t(vertices_at(parts, next_log(random, -0.8f, 1.4f)) * double(random.next_in(0.8f, 1.0f)));
        if (budget < 100) continue;
        const float d = solve_sample_distance(histogram, 0, budget, k_least, k_most);
        if (d <= k_least || d >= k_most) continue;
        const double drawn = vertices_at(parts, d);
        if (std::fabs(drawn - double(budget)) <= 0.005 * double(budget)) {
            ++exact;
            continue;
        }
        ++jumps;
        EXPECT_LT(drawn, double(budget));
        EXPECT_GT(vertices_at(parts, double(d) * (1.0 - 0.0025)), 1.005 * double(budget));
    }
    EXPECT_GT(exact, 100);
    EXPECT_GT(jumps, 20);
}

// One part of lines that alone decides: triangles while they fit, else the coarser side, all lines.
TEST(SampleDistance, OneJumpIsTakenFromTheCheapSide) {
    Parts parts;
    parts.lines.push_back({4000.0f, 4.0f, 9000.0f});
    const BudgetHistogram histogram = histogram_of(parts);
    const float d = solve_sample_distance(histogram, 0, 5000, k_least, k_most);
    EXPECT_LE(vertices_at(parts, d), 1000.0);
    EXPECT_NEAR(d, 4.0f, 0.01f);
    // V is 9000 from the least d' on; so does this budget hold them.
    EXPECT_EQ(solve_sample_distance(histogram, 0, 9000, k_least, k_most), k_least);
    EXPECT_NEAR(solve_sample_distance(histogram, 0, 500, k_least, k_most), 8.0f, 0.02f);
}

// A jump at any d', at bins' edges also, is passed by where its triangles do not fit.
TEST(SampleDistance, EdgesOfBinsAgreeWithTheRuleOfLines) {
    Random random(4);
    auto expect_passed = [](float jump) {
        BudgetHistogram histogram;
        histogram.add_lines(10.0f, jump, 3000.0f);
        EXPECT_GT(solve_sample_distance(histogram, 0, 1000, k_least, k_most), jump);
    };
    for (float octave_px2 : {0.25f, 0.5f, 1.0f, 2.0f, 1024.0f})
        for (int i = 0; i < 256; ++i) expect_passed(std::sqrt(octave_px2 * (1.0f + float(i) / 256.0f)));
    for (int round = 0; round < 2000; ++round) expect_passed(next_log(random, -0.8f, 2.5f));
}

// Cooks may store other than two points a triangle; clouds have no triangles at all.
TEST(SampleDistance, KnowsTheLawsOfAllRatiosOfPointsToTriangles) {
    Random random(5);
    for (float most_over_stored : {1.0f, 1.2f, 1.5f, 2.0f, 3.0f}) {
        Parts parts;
        for (int i = 0; i < 3000; ++i) {
            const float stored = std::floor(next_log(random, 1.0f, 4.0f));
            parts.points.push_back(
                {stored * next_log(random, -3.0f, 3.0f), stored, most_over_stored * stored});
        }
        const BudgetHistogram histogram = histogram_of(parts);
        for (float at_px : {0.2f, 1.0f, 5.0f, 30.0f}) {
            const double budget = std::floor(vertices_at(parts, at_px));
            const float d = solve_sample_distance(histogram, 0, uint64_t(budget), k_least, k_most);
            EXPECT_LT(error_of(parts, budget, d), 0.005) << most_over_stored << " at " << at_px;
        }
    }
}

TEST(SampleDistance, SwitchesAtStoredWhereNothingBlends) {
    BudgetHistogram histogram;
    histogram.add_switching_points(4.0f * 1000.0f, 1000.0f, 1500.0f);  // triangles at d' <= 2
    EXPECT_NEAR(solve_sample_distance(histogram, 0, 250, k_least, k_most), 4.0f, 0.01f);
    EXPECT_NEAR(solve_sample_distance(histogram, 0, 1200, k_least, k_most), 2.0f, 0.01f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1500, k_least, k_most), k_least);
}

// Sums of integers: the order of parts, and how they are cut into jobs, changes no bit.
TEST(SampleDistance, SameBitsFromAnyNumberOfJobs) {
    Random random(6);
    const Parts parts = random_parts(random, 20'000, 0.3f);
    const BudgetHistogram all = histogram_of(parts);
    for (size_t jobs : {2u, 7u, 64u}) {
        std::vector<BudgetHistogram> histograms(jobs);
        for (size_t i = parts.points.size(); i-- > 0;)
            histograms[i % jobs].add_points(parts.points[i].wanted, parts.points[i].stored,
                                            parts.points[i].most);
        for (size_t i = parts.lines.size(); i-- > 0;)
            histograms[(i * 31) % jobs].add_lines(parts.lines[i].wanted, parts.lines[i].triangles_below,
                                                  parts.lines[i].most);
        BudgetHistogram sum;
        for (size_t job = jobs; job-- > 0;) sum.add(histograms[job]);
        EXPECT_TRUE(sum == all) << jobs;
    }
    BudgetHistogram cleared = all;
    cleared.clear();
    EXPECT_TRUE(cleared == BudgetHistogram());
}

// The same d' from every compiler.
TEST(SampleDistance, SameBitsFromAnyCompiler) {
    Random random(14);
    BudgetHistogram histogram;
    for (int i = 0; i < 10'000; ++i) {
        const float triangles = float(1 + random.next_below(5000));
        const float px = 0.1f + 8.0f * random.next_unit() * random.next_unit();
        histogram.add_points(3.0f * triangles * px * px, 2.0f * triangles, 3.0f * triangles);
        histogram.add_lines(0.4f * triangles * px, px, 3.0f * triangles);
    }
    const float d = solve_sample_distance(histogram, 12'345, 40'000'000, k_least, k_most);
    EXPECT_EQ(std::bit_cast<uint32_t>(d), 1082240262u) << d;
}

TEST(SampleDistance, FallsWithTheBudget) {
    Random random(7);
    const BudgetHistogram histogram = histogram_of(random_parts(random, 5000, 0.3f));
    float before = k_most;
    for (double budget = 1.0; budget < 1e9; budget *= 1.01) {
        const float d = solve_sample_distance(histogram, 0, uint64_t(budget), k_least, k_most);
        ASSERT_LE(d, before) << budget;
        before = d;
    }
    EXPECT_EQ(before, k_least);
}

TEST(SampleDistance, LeavesRoomForWhatIsFixed) {
    BudgetHistogram histogram;
    histogram.add_points(1.0e6f, 1.0e7f, 1.5e7f);
    EXPECT_NEAR(solve_sample_distance(histogram, 750'000, 1'000'000, k_least, k_most), 2.0f, 0.01f);
    histogram.add_always(500'000.0f);
    EXPECT_NEAR(solve_sample_distance(histogram, 250'000, 1'000'000, k_least, k_most), 2.0f, 0.01f);
    EXPECT_EQ(solve_sample_distance(histogram, 2'000'000, 1'000'000, k_least, 16.0f), 16.0f);
    EXPECT_EQ(solve_sample_distance(histogram, UINT64_MAX, 1, k_least, 16.0f), 16.0f);
}

TEST(SampleDistance, LimitsHold) {
    BudgetHistogram histogram;
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1000, 0.5f, 16.0f), 0.5f);  // nothing in view
    EXPECT_EQ(solve_sample_distance(histogram, 0, 0, 0.5f, 16.0f), 16.0f);
    histogram.add_points(1.0e6f, 1.0e7f, 1.5e7f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 0, 0.5f, 16.0f), 16.0f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1, 0.5f, 16.0f), 16.0f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, UINT64_MAX, 0.5f, 16.0f), 0.5f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1'000'000, 2.0f, 16.0f), 2.0f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1'000'000, 0.1f, 0.5f), 0.5f);
    EXPECT_EQ(solve_sample_distance(histogram, 0, 1, 0.0f, k_inf), k_most);
    EXPECT_EQ(solve_sample_distance(histogram, 0, UINT64_MAX, -1.0f, k_inf), k_least);
    // Limits that make no sense still give a distance.
    for (float least : {k_nan, k_inf, -k_inf, 0.0f, 1.0e30f})
        for (float most : {k_nan, k_inf, -k_inf, 0.0f, 1.0e-30f}) {
            const float d = solve_sample_distance(histogram, 0, 1000, least, most);
            EXPECT_TRUE(d >= k_least && d <= k_most) << least << " " << most;
        }
}

TEST(SampleDistance, BrokenCountsAreClampedOrIgnored) {
    const float odd[] = {k_nan,    k_inf,    -k_inf,  -1.0f,   0.0f,   -0.0f,
                         1.0e-42f, 1.0e-30f, 1.0e30f, 3.0e38f, 4.3e9f, 1.0f};
    BudgetHistogram sane;
    sane.add_points(1.0e6f, 1.0e6f, 1.5e6f);
    for (float a : odd)
        for (float b : odd)
            for (float c : odd) {
                BudgetHistogram histogram = sane;
                histogram.add_points(a, b, c);
                histogram.add_switching_points(a, b, c);
                histogram.add_lines(a, b, c);
                if (!(a > 0.0f) || !(c >= 0.0f)) {
                    EXPECT_TRUE(histogram == sane) << a << " " << b << " " << c;
                }
                histogram.add_always(a);
                for (uint64_t budget : {uint64_t(1), uint64_t(1'000'000), UINT64_MAX}) {
                    const float d = solve_sample_distance(histogram, 0, budget, k_least, k_most);
                    ASSERT_TRUE(d >= k_least && d <= k_most) << a << " " << b << " " << c;
                }
            }
    // Infinitely much is wanted: all that is stored is drawn, at any d'.
    BudgetHistogram whole;
    whole.add_points(k_inf, 1000.0f, 1500.0f);
    EXPECT_EQ(solve_sample_distance(whole, 0, 1500, k_least, k_most), k_least);
    EXPECT_EQ(solve_sample_distance(whole, 0, 1499, k_least, k_most), k_most);
}

// A few triangles in view, nearly all of them far below a vertex each.
TEST(SampleDistance, CountsFractionsOfAVertex) {
    Parts parts;
    Random random(8);
    for (int i = 0; i < 200'000; ++i)
        parts.points.push_back({next_log(random, -4.0f, -1.0f), 20'000.0f, 30'000.0f});
    const BudgetHistogram histogram = histogram_of(parts);
    const double budget = std::floor(vertices_at(parts, 1.0));
    const float d = solve_sample_distance(histogram, 0, uint64_t(budget), k_least, k_most);
    EXPECT_LT(error_of(parts, budget, d), 0.005);
}

// 64 plants of four parts, as the frame draws them, with gains that change with d' as measured ones do.
struct Stand {
    std::vector<PackedPart> parts;
    std::vector<PlantView> views;
};

Stand random_stand(Random& random, float gain_an_octave, float nearer) {
    Stand stand;
    for (int i = 0; i < 40; ++i) {
        PackedPart part{};
        part.kind = i % 3 == 0 ? PackedPartKind::lines : PackedPartKind::points;
        part.importance = random.next_in(0.5f, 2.0f);
        part.triangle_count = uint32_t(next_log(random, 1.5f, 4.3f));
        if (part.kind == PackedPartKind::points) part.point_count = 2 * part.triangle_count;
        if (part.kind == PackedPartKind::lines) part.line_count = 1 + part.triangle_count / 8;
        part.area_m2 = next_log(random, -1.0f, 1.5f);
        const float area = 0.5f * part.area_m2, length = 40.0f * part.area_m2;
        part.projected_area_m2.m = {area * area, area * area, area * area, 0.0f, 0.0f, 0.0f};
        part.projected_length_m.m = {length * length, length * length, length * length, 0.0f, 0.0f, 0.0f};
        part.line_length_m = length / (0.25f * k_pi);
        part.line_error_m = next_log(random, -3.0f, -1.5f);
        for (uint32_t level = 0; level < k_gain_levels; ++level)
            part.coverage_gain[level] = 1.3f * std::pow(gain_an_octave, float(k_gain_levels - 1 - level));
        stand.parts.push_back(part);
    }
    for (int i = 0; i < 2000; ++i)
        stand.views.push_back({vec3(0.0f, 0.0f, -1.0f), nearer * 600.0f / next_log(random, 0.7f, 3.0f)});
    return stand;
}

double vertices_drawn(const Stand& stand, float d, Random& random) {
    FrameSettings settings;
    settings.sample_distance_px = d;
    double vertices = 0.0;
    for (const PlantView& view : stand.views)
        for (const PackedPart& part : stand.parts) {
            const PartChoice choice = choose_part(part, view, settings, random.next_unit());
            vertices +=
                double(choice.points - choice.skipped_points) + 2.0 * choice.lines + 3.0 * choice.triangles;
        }
    return vertices;
}

float settle(const Stand& stand, float guess, uint64_t budget, int& passes) {
    return settle_sample_distance(guess, [&](float d) {
        ++passes;
        FrameSettings settings;
        settings.sample_distance_px = d;
        BudgetHistogram histogram;
        for (const PlantView& view : stand.views)
            for (const PackedPart& part : stand.parts) add_part(histogram, part, view, settings);
        return solve_sample_distance(histogram, 0, budget, k_least, k_most);
    });
}

// What counts in the end: choose_part draws the budget, in the first frame of a view it has never seen.
TEST(SampleDistance, ChoosePartDrawsTheBudgetAlsoAfterACameraCut) {
    Random random(9);
    constexpr uint64_t k_budget = 2'000'000;
    float guess = 1.0f;
    for (float nearer : {1.0f, 3.0f, 0.5f, 8.0f, 0.2f}) {
        const Stand stand = random_stand(random, 0.85f, nearer);
        int passes = 0;
        guess = settle(stand, guess, k_budget, passes);
        EXPECT_GT(guess, k_least);
        EXPECT_LT(guess, k_most);
        EXPECT_NEAR(vertices_drawn(stand, guess, random), double(k_budget), 0.01 * double(k_budget))
            << nearer;
        EXPECT_LE(passes, 4);
        // The same view once more.
        passes = 0;
        const float again = settle(stand, guess, k_budget, passes);
        EXPECT_EQ(passes, 1) << nearer;
        EXPECT_NEAR(again, guess, 0.005f * guess);
    }
}

// Clouds of tiles, whose counts follow no power of d'.
// Leaves of two, three and ten triangles, and where leaves end among points, in the blend and past it.
TEST(SampleDistance, KnowsWhatLeavesDraw) {
    for (FoliageMode mode : {FoliageMode::leaves, FoliageMode::automatic})
        for (bool blend : {true, false})
            for (uint32_t triangles : {300u, 600u, 900u, 3000u, 13000u}) {
                PackedPart part{};
                part.importance = 1.0f;
                part.triangle_count = triangles;
                part.point_count = 2 * triangles;
                part.area_m2 = 2.0f;
                part.projected_area_m2.m = {1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f};
                part.coverage_gain.fill(1.0f);
                FrameSettings settings;
                settings.foliage = mode;
                settings.blend = blend;
                const LeafLevels levels{300, 16};
                const PlantView view{vec3(0, 0, -1), 40.0f};
                BudgetHistogram histogram;
                const PartRule at_1px(part, settings, levels);
                add_part(histogram, part, at_1px, at_1px.demand(project_part(part, view, settings)), settings);
                for (float d = 0.14f; d < 20.0f; d *= 1.07f) {
                    settings.sample_distance_px = d;
                    double drawn = 0.0;
                    for (int i = 0; i < 64; ++i) {
                        const PartChoice choice =
                            choose_part(part, view, settings, std::fmod(0.618034f * float(i), 1.0f), levels);
                        drawn += (double(choice.points) - choice.skipped_points + 3.0 * choice.triangles +
                                  4.0 * choice.leaves) / 64.0;
                    }
                    // Rounding, and 0.4 % of a step of d'^2; a jump is on either side of its bin.
                    const double finer = vertices_at(histogram, d * 1.003f), coarser = vertices_at(histogram, d * 0.997f);
                    EXPECT_GE(drawn, std::min(finer, coarser) * 0.985 - 4.0) << triangles << " " << d;
                    EXPECT_LE(drawn, std::max(finer, coarser) * 1.015 + 4.0) << triangles << " " << d;
                }
            }
}

TEST(SampleDistance, ChooseCloudDrawsTheBudget) {
    Random random(10);
    struct Cloud {
        std::vector<float> densities;
        float pixels_per_meter;
    };
    std::vector<Cloud> clouds(300);
    for (Cloud& cloud : clouds) {
        const float power = random.next_in(0.6f, 1.3f);
        const size_t count = random.next_below(8192);
        for (size_t i = 0; i < count; ++i)
            cloud.densities.push_back(100.0f *
                                      std::pow((float(i) + random.next_unit()) / 8192.0f, 1.0f / power));
        // A tenth of the points of every fifth cloud appear at once, as the first points of equal plants do.
        if ((&cloud - clouds.data()) % 5 == 0)
            for (size_t i = count / 2; i < count / 2 + count / 10; ++i)
                cloud.densities[i] = cloud.densities[count / 2];
        cloud.pixels_per_meter = next_log(random, -1.0f, 1.5f);
    }
    for (uint64_t budget : {20'000u, 200'000u, 800'000u}) {
        FrameSettings settings;
        BudgetHistogram histogram;
        for (const Cloud& cloud : clouds)
            add_cloud(histogram, cloud.densities, cloud.pixels_per_meter, settings);
        settings.sample_distance_px = solve_sample_distance(histogram, 0, budget, k_least, k_most);
        double points = 0.0;
        for (const Cloud& cloud : clouds) {
            const PartChoice choice = choose_cloud({}, cloud.densities, cloud.pixels_per_meter, 10.0f, 10.0f,
                                                   1.5f * cloud.pixels_per_meter, settings);
            points += double(choice.points - choice.skipped_points);
        }
        EXPECT_GT(settings.sample_distance_px, k_least);
        EXPECT_NEAR(points, double(budget), 0.015 * double(budget));
    }
}

TEST(SampleDistance, BrokenCloudsAreIgnored) {
    const std::vector<float> odd[] = {{},
                                      {k_nan, k_nan},
                                      {0.0f, 0.0f},
                                      {-1.0f},
                                      {k_inf, k_inf, k_inf},
                                      {0.0f, k_inf},
                                      {k_nan, k_nan, 1.0f}};
    for (const std::vector<float>& densities : odd) {
        BudgetHistogram histogram;
        add_cloud(histogram, densities, 10.0f, {});
        const float d = solve_sample_distance(histogram, 0, 1, k_least, k_most);
        EXPECT_TRUE(d >= k_least && d <= k_most);
    }
    BudgetHistogram histogram;
    for (float pixels_per_meter : {0.0f, k_nan})
        add_cloud(histogram, std::vector{1.0f, 2.0f}, pixels_per_meter, {});
    EXPECT_TRUE(histogram == BudgetHistogram());
}

TEST(SampleDistance, WithoutLevelsOfDetailAllTrianglesCount) {
    Random random(11);
    const Stand stand = random_stand(random, 0.85f, 1.0f);
    FrameSettings settings;
    settings.level_of_detail = false;
    BudgetHistogram histogram;
    double all = 0.0;
    for (const PackedPart& part : stand.parts) {
        add_part(histogram, part, stand.views[0], settings);
        all += 3.0 * part.triangle_count;
    }
    EXPECT_EQ(solve_sample_distance(histogram, 0, uint64_t(all), k_least, k_most), k_least);
    EXPECT_EQ(solve_sample_distance(histogram, 0, uint64_t(all) - 1, k_least, k_most), k_most);
}

}  // namespace
}  // namespace coppice
