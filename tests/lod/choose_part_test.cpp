#include "plugins/vegetation/lod/choose_part.h"

#include <gtest/gtest.h>
#include "plugins/vegetation/plant/line_points.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

PackedPart leaf_part(uint32_t triangles) {
    PackedPart part{};
    part.kind = PackedPartKind::points;
    part.importance = 1.0f;
    part.triangle_count = triangles;
    part.point_count = 2 * triangles;
    part.area_m2 = 2.0f;
    part.projected_area_m2.m = {1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f};  // 1 m2 from everywhere
    part.coverage_gain.fill(1.0f);
    return part;
}

PackedPart twig_part() {
    PackedPart part{};
    part.kind = PackedPartKind::lines;
    part.importance = 1.0f;
    part.triangle_count = 600;
    part.line_count = 100;
    part.line_length_m = 50.0f;
    part.line_error_m = 0.005f;
    part.area_m2 = 2.0f;
    part.projected_area_m2.m = {0.16f, 0.16f, 0.16f, 0.0f, 0.0f, 0.0f};  // squares: 0.4 m2 from everywhere
    part.projected_length_m.m = {1521.0f, 1521.0f, 1521.0f, 0.0f, 0.0f, 0.0f};
    part.coverage_gain.fill(1.0f);
    return part;
}

PartChoice choose_points(const PackedPart& part, float area_px2, const FrameSettings& settings,
                         float chance) {
    const PartRule rule(part, settings);
    return rule.expand(rule.choose({0.0f, area_px2, 0.0f, 0.0f, 1.0f}, chance), 1.0f);
}

PlantView view_at(float pixels_per_meter) { return {vec3(0, 0, -1), pixels_per_meter}; }

// Blending draws p vertices, never more than 3k (paper, section 5.3).
TEST(ChoosePoints, DrawsAsManyVerticesAsAskedFor) {
    PackedPart part = leaf_part(1000);
    FrameSettings settings;
    for (float p = 1.0f; p < 4000.0f; p *= 1.03f) {
        PartChoice choice =
            choose_points(part, p, settings, 0.5f);  // d' = 1, c_p = 1: p points for p square pixels
        uint32_t drawn_points = choice.points - choice.skipped_points;
        uint32_t vertices = drawn_points + 3 * choice.triangles;
        EXPECT_NEAR(float(vertices), std::min(p, 3000.0f), 2.0f) << p;
    }
}

TEST(ChoosePoints, SquaresCoverTheProjectedArea) {
    PackedPart part = leaf_part(1000);
    for (float c_p : {1.0f, 1.3f})
        for (float d : {0.5f, 1.0f, 2.5f}) {
            FrameSettings settings;
            settings.sample_distance_px = d;
            settings.splat_factor = c_p;
            for (float area = 100.0f; area < 1900.0f * d * d / c_p; area *= 1.1f) {
                PartChoice choice = choose_points(part, area, settings, 0.0f);
                ASSERT_EQ(choice.triangles, 0u);
                const float square_px2 = choice.splat_px * choice.splat_px * choice.mean_facing;
                const float covered = float(choice.points) * square_px2;
                EXPECT_NEAR(covered, c_p * area, 0.02f * c_p * area + square_px2);
            }
        }
}

TEST(ChoosePoints, ImportanceAddsSmallerPointsNotCoverage) {
    PackedPart plain = leaf_part(1000), important = leaf_part(1000);
    important.importance = 3.0f;
    FrameSettings settings;
    PartChoice a = choose_points(plain, 300.0f, settings, 0.0f),
               b = choose_points(important, 300.0f, settings, 0.0f);
    EXPECT_NEAR(float(b.points), 3.0f * float(a.points), 3.0f);
    EXPECT_NEAR(float(b.points) * b.splat_px * b.splat_px, float(a.points) * a.splat_px * a.splat_px, 3.0f);
}

TEST(ChoosePoints, FractionsOfAPointAreRightInTheMean) {
    PackedPart part = leaf_part(1000);
    Random random(3);
    double points = 0.0;
    constexpr int k_draws = 100000;
    for (int i = 0; i < k_draws; ++i) points += choose_points(part, 0.3f, {}, random.next_unit()).points;
    EXPECT_NEAR(points / k_draws, 0.3, 0.01);
}

TEST(ChoosePoints, WithoutBlendingSwitchesAtOnce) {
    PackedPart part = leaf_part(1000);
    FrameSettings settings;
    settings.blend = false;
    EXPECT_EQ(choose_points(part, 1999.0f, settings, 0.0f).triangles, 0u);
    EXPECT_EQ(choose_points(part, 2001.0f, settings, 0.0f).triangles, 1000u);
    EXPECT_EQ(choose_points(part, 2001.0f, settings, 0.0f).points, 0u);
}

// What is seen of a point from the side it shows by |n . v|; which points are drawn, a tile's cloud must know for all sides.
// 600 triangles, two a leaf.
TEST(ChooseLeaves, StandBetweenTrianglesAndPointsWithAsManyVertices) {
    const PackedPart part = leaf_part(600);
    FrameSettings settings;
    settings.splat_factor = 1.0f;
    settings.weigh_by_facing = false;
    settings.foliage = FoliageMode::leaves;
    const PartRule rule(part, settings, {300, 16});
    auto choice_at = [&](float p, float chance) {
        return rule.expand(rule.choose({0.0f, p, 0.0f, 0.0f, 1.0f}, chance), 1.0f);
    };
    for (float chance : {0.0f, 0.5f, 0.998f})
        for (float p : {90.0f, 400.0f, 1100.0f, 1199.0f}) {
            const PartChoice choice = choice_at(p, chance);
            EXPECT_EQ(choice.triangles + choice.points, 0u) << p;
            EXPECT_NEAR(4.0 * double(choice.leaves), double(p), 4.0) << p;
        }
    EXPECT_EQ(choice_at(1500.0f, 0.0f).leaves, 300u) << "all of them until triangles have no more vertices";
    EXPECT_EQ(choice_at(1799.0f, 0.0f).leaves, 300u);
    EXPECT_EQ(choice_at(1800.0f, 0.0f).triangles, 600u);
    EXPECT_EQ(choice_at(1800.0f, 0.0f).leaves, 0u);
    EXPECT_EQ(choice_at(64.0f * 0.79f, 0.998f).points, 51u) << "below the last level";
    // Each plant changes to points at a p of its own.
    uint32_t as_leaves = 0;
    for (int i = 0; i < 1024; ++i) as_leaves += choice_at(64.0f, (float(i) + 0.5f) / 1024.0f).leaves > 0;
    EXPECT_NEAR(as_leaves, 512, 80);
}

TEST(ChooseLeaves, AutomaticDrawsThemWhereTheyWereMeasuredToWin) {
    PackedPart part = leaf_part(3000);  // ten triangles a leaf
    FrameSettings settings;
    settings.splat_factor = 1.0f;
    settings.weigh_by_facing = false;
    const LeafLevels levels{300, 16};
    const LeafRange range = automatic_leaf_range(part, 300, 16);
    EXPECT_LT(range.from, range.to);
    auto leaves_at = [&](float p) {
        return PartRule(part, settings, levels).choose({0.0f, p, 0.0f, 0.0f, 1.0f}, 0.5f / 256.0f).form ==
               PartRule::Form::leaves;
    };
    EXPECT_TRUE(leaves_at(1.01f * range.from));
    EXPECT_TRUE(leaves_at(0.99f * range.to));
    EXPECT_FALSE(leaves_at(0.79f * range.from));
    EXPECT_FALSE(leaves_at(1.01f * range.to));
    settings.foliage = FoliageMode::points;
    EXPECT_FALSE(leaves_at(1.2f * range.from));
    settings.foliage = FoliageMode::leaves;
    EXPECT_TRUE(leaves_at(0.5f * range.from));
    EXPECT_TRUE(leaves_at(2.0f * range.to));
    settings.level_of_detail = false;
    EXPECT_FALSE(leaves_at(1.2f * range.from)) << "all triangles";
    const LeafRange none = automatic_leaf_range(leaf_part(400), 300, 16);
    EXPECT_LE(none.to, none.from) << "as many vertices as the triangles";
}

TEST(ChoosePart, PointsAreThoseOfAllSides) {
    PackedPart card = leaf_part(1000);
    card.projected_area_m2.m = {4.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};  // 2 m2 that face x
    for (uint32_t flags : {0u, k_part_closed}) {
        card.flags = flags;
        const PartChoice front = choose_part(card, {vec3(1, 0, 0), 20.0f}, {}, 0.5f),
                         edge = choose_part(card, {vec3(0, 0, 1), 20.0f}, {}, 0.5f);
        EXPECT_EQ(front.points, flags ? 200u : 400u);
        EXPECT_EQ(edge.points, front.points);
        EXPECT_FLOAT_EQ(edge.splat_px, front.splat_px);
        // All its points have |n . v| = 1 from the front, and then cover what is seen there, a half of what is closed.
        EXPECT_NEAR(float(front.points) * front.splat_px * front.splat_px, flags ? 400.0f : 800.0f, 1.0f);
    }
    FrameSettings alike;
    alike.weigh_by_facing = false;
    card.flags = 0;
    EXPECT_EQ(choose_part(card, {vec3(1, 0, 0), 20.0f}, alike, 0.5f).points, 800u);
    EXPECT_EQ(choose_part(card, {vec3(0, 0, 1), 20.0f}, alike, 0.5f).points, 0u);
}

TEST(ChooseLines, LinesOfWidthDCoverTheProjectedArea) {
    PackedPart part = twig_part();
    FrameSettings settings;
    settings.projection = ProjectionMode::measured;
    for (float ppm = 5.0f; ppm < 90.0f; ppm *= 1.2f) {
        PlantView view = view_at(ppm);
        PartChoice choice = choose_part(part, view, settings, 0.5f);
        ASSERT_GT(choice.lines, 0u) << ppm;
        float length_px = projected_length_px(part, view, settings.projection);
        float covered = float(choice.lines) / float(part.line_count) * length_px * choice.line_width_px;
        float area = projected_area_px2(part, view, settings.projection);
        EXPECT_NEAR(covered, area, 0.06f * area + length_px / float(part.line_count)) << ppm;
    }
}

TEST(ChooseLines, TrianglesWhereTheErrorShowsOrLinesWouldNotFill) {
    PackedPart part = twig_part();
    EXPECT_EQ(choose_part(part, view_at(201.0f), {}, 0.0f).triangles, 600u);  // eps 0.005 m is over a pixel
    EXPECT_EQ(choose_part(part, view_at(150.0f), {}, 0.0f).triangles, 600u);  // q = 0.4 / 39 * 150 > 1
    EXPECT_EQ(choose_part(part, view_at(50.0f), {}, 0.0f).triangles, 0u);
}

// Where lines are shorter than d', or few points would do. As much is covered by either.
TEST(ChooseLines, FarAwayPointsStandForThem) {
    PackedPart twigs = twig_part(), trunk = twig_part();  // twigs: lines of 0.5 m
    trunk.line_count = 2;                                 // of 25 m
    EXPECT_GT(choose_part(twigs, view_at(6.0f), {}, 0.5f).lines, 0u);
    EXPECT_EQ(choose_part(twigs, view_at(6.0f), {}, 0.5f).points, 0u);
    EXPECT_EQ(choose_part(twigs, view_at(1.0f), {}, 0.5f).lines, 0u);
    EXPECT_EQ(choose_part(trunk, view_at(3.0f), {}, 0.5f).lines, 0u);
    twigs.importance = trunk.importance = 2.0f;
    for (const PackedPart* part : {&twigs, &trunk}) {
        const PlantView view = view_at(1.5f);
        double covered = 0.0;
        constexpr int k_chances = 1000;
        for (int i = 0; i < k_chances; ++i) {
            const PartChoice choice = choose_part(*part, view, {}, (float(i) + 0.5f) / k_chances);
            ASSERT_EQ(choice.lines, 0u);
            ASSERT_GT(choice.density_limit_m2, 0.0f) << "the points say how large they are";
            covered += 0.5 * double(choice.points) * double(choice.splat_px * choice.splat_px) / k_chances;
        }
        // A quarter of 2 m2 would be 0.5; the part is not closed: twice that.
        EXPECT_NEAR(covered, 1.5 * 1.5 * 1.0, 0.02);
    }
    FrameSettings alike;
    alike.weigh_by_facing = false;
    EXPECT_EQ(choose_part(twigs, view_at(0.5f), alike, 0.5f).points, 0u);
}

// No two plants of a stand change at once.
TEST(ChooseLines, EachPlantGoesOverAtADistanceOfItsOwn) {
    const PackedPart part = twig_part();
    float before = -1.0f;
    for (float per_meter = 1.0f; per_meter < 6.0f; per_meter *= 1.02f) {
        float with_lines = 0.0f;
        constexpr int k_plants = 4096;
        for (int i = 0; i < k_plants; ++i)
            with_lines += choose_part(part, view_at(per_meter), {}, float(i) / k_plants).lines > 0
                              ? 1.0f / k_plants
                              : 0.0f;
        if (before >= 0.0f) {
            EXPECT_NEAR(with_lines, before, 0.08f) << per_meter;
        }
        before = with_lines;
    }
    EXPECT_FLOAT_EQ(before, 1.0f);
}

TEST(ChooseLines, PrintedAndIsotropicDifferByThePaperOverCount) {
    PackedPart part = twig_part();
    FrameSettings printed, isotropic;
    printed.projection = ProjectionMode::printed;
    isotropic.projection = ProjectionMode::isotropic;
    float a = float(choose_part(part, view_at(20.0f), printed, 0.5f).lines);
    float b = float(choose_part(part, view_at(20.0f), isotropic, 0.5f).lines);
    EXPECT_NEAR(a / b, k_pi / 2.0f, 0.05f);  // ERRATA 2: 57 % too many
}

TEST(ChoosePart, EverySizeAndSettingHasAnAnswer) {
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
        PackedPart part = random.next_below(2) ? leaf_part(random.next_below(50)) : twig_part();
        if (random.next_below(4) == 0) part.line_count = 0;
        if (random.next_below(4) == 0) part.point_count = 0;
        if (random.next_below(8) == 0) part.projected_area_m2.m = {};
        if (random.next_below(8) == 0) part.projected_length_m.m = {};
        FrameSettings settings;
        settings.sample_distance_px = portable_exp2(random.next_in(-12.0f, 12.0f));
        settings.splat_factor = random.next_in(0.0f, 2.0f);
        settings.blend = random.next_below(2);
        PlantView view = view_at(portable_exp2(random.next_in(-40.0f, 40.0f)));
        PartChoice choice = choose_part(part, view, settings, random.next_unit());
        EXPECT_LE(choice.triangles, part.triangle_count);
        EXPECT_LE(choice.points,
                  part.kind == PackedPartKind::lines ? line_point_count(part) : part.point_count);
        EXPECT_LE(choice.lines, part.line_count);
        EXPECT_TRUE(std::isfinite(choice.splat_px) && std::isfinite(choice.line_width_px));
    }
}

TEST(PixelsPerMeter, StaysFiniteInsideAPlant) {
    EXPECT_FLOAT_EQ(pixels_per_meter(600.0f, 0.0f, 3.0f, 0.1f, 1.0f), 6000.0f);
    EXPECT_FLOAT_EQ(pixels_per_meter(600.0f, 10.0f, 3.0f, 0.1f, 2.0f), 120.0f);
    EXPECT_FLOAT_EQ(pixels_per_meter(600.0f, 0.0f, 0.0f, 0.1f, 1.0f), 6000.0f);
    float before = 0.0f;  // grows all the way in
    for (float distance_m = 20.0f; distance_m > 0.0f; distance_m -= 0.01f) {
        float here = pixels_per_meter(600.0f, distance_m, 3.0f, 0.1f, 1.0f);
        EXPECT_GE(here, before);
        EXPECT_TRUE(before == 0.0f || here < 1.5f * before || distance_m < 3.0f) << distance_m;
        before = here;
    }
}

// Loops over plants are made vectors of; what they choose is what is chosen for each plant alone.
TEST(ChooseParts, ManyAreChosenAsOneIs) {
    Random random(17);
    PackedPart leaves = leaf_part(40), twigs = twig_part(), trunk = twig_part(), bare = leaf_part(3);
    trunk.line_count = 1;
    bare.point_count = 0;
    for (PackedPart* part : {&leaves, &twigs, &trunk})
        for (size_t level = 0; level < k_gain_levels; ++level) {
            part->coverage_gain[level] = 0.7f + 0.6f * random.next_unit();
            part->height_gain[level / 2] = {int8_t(level * 3), int8_t(-20 + int(level) * 2)};
        }
    for (const PackedPart* part : {&leaves, &twigs, &trunk, &bare})
        for (ProjectionMode mode : {ProjectionMode::measured, ProjectionMode::isotropic})
            for (float d : {0.3f, 1.0f, 2.5f})
                for (bool plain : {false, true}) {
                    FrameSettings settings;
                    settings.sample_distance_px = d;
                    settings.projection = mode;
                    settings.weigh_by_facing = settings.blend = !plain;
                    constexpr size_t k_count = 203;  // no multiple of any vector's length
                    std::vector<float> x(k_count), y(k_count), z(k_count), per_meter(k_count),
                        chances(k_count);
                    for (size_t i = 0; i < k_count; ++i) {
                        x[i] = 0.6f * random.next_unit();
                        y[i] = 0.6f * random.next_unit();
                        z[i] = std::sqrt(1.0f - x[i] * x[i] - y[i] * y[i]);
                        per_meter[i] = i == 0 ? 0.0f : std::exp(9.0f * random.next_unit() - 4.0f);
                        chances[i] = random.next_unit();
                    }
                    const PlantViews views{x, y, z, per_meter};
                    settings.foliage = plain ? FoliageMode::leaves : FoliageMode::automatic;
                    const PartRule rule(*part, settings, {16, 2});
                    PartDemands demands;
                    PartChoices choices;
                    rule.demand(*part, views, settings, demands);
                    choose_parts(rule, demands, chances, choices);
                    for (size_t i = 0; i < k_count; ++i) {
                        const PartDemand demand = rule.demand(project_part(*part, views[i], settings));
                        const PartRule::Choice choice = rule.choose(demand, chances[i]);
                        ASSERT_EQ(demands.side_gain[i], demand.side_gain) << i;
                        ASSERT_EQ(choices.form[i], choice.form) << i;
                        ASSERT_EQ(choices.count[i], choice.count) << i;
                        ASSERT_EQ(choices.asked[i], choice.asked) << i;
                    }
                }
}

}  // namespace
}  // namespace coppice
