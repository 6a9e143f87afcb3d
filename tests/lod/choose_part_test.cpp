#include "plugins/vegetation/lod/choose_part.h"

#include <gtest/gtest.h>
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
                float covered = float(choice.points) * choice.splat_px * choice.splat_px;
                EXPECT_NEAR(covered, c_p * area, 0.02f * c_p * area + choice.splat_px * choice.splat_px);
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
        EXPECT_LE(choice.points, part.point_count);
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

}  // namespace
}  // namespace coppice
