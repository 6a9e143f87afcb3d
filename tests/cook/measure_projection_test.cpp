#include "plugins/vegetation/cook/measure_projection.h"

#include <gtest/gtest.h>
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

// Root of the mean squared difference between the form and the values it was fitted to, over their mean.
double fit_error(const std::array<double, k_projection_direction_count>& values) {
    DirectionForm form = fit_direction_form(values);
    double mean = 0, square = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        double off = double(form.evaluate(projection_directions()[i])) - values[i];
        square += off * off;
        mean += values[i];
    }
    mean /= double(values.size());
    return std::sqrt(square / double(values.size())) / mean;
}

TEST(FitDirectionForm, IsExactForAFlatPart) {
    PartDescription quad;
    shapes::add_quad(quad, vec3(1, 2, 3), vec3(2, 0, 0), vec3(0, 0, 3));
    DirectionForm form = fit_direction_form(projected_areas_m2(quad, false));
    EXPECT_NEAR(form.evaluate(vec3(0, 1, 0)), 6.0f, 1e-3f);
    EXPECT_NEAR(form.evaluate(vec3(0, 0.6f, 0.8f)), 3.6f, 1e-3f);
    EXPECT_NEAR(form.evaluate(vec3(1, 0, 0)), 0.0f, 0.1f);
}

TEST(FitDirectionForm, ASphereShowsADiscFromEverySide) {
    auto areas = projected_areas_m2(shapes::sphere(48, 96, 1), true);
    DirectionForm form = fit_direction_form(areas);
    for (vec3 d : projection_directions()) EXPECT_NEAR(form.evaluate(d), k_pi, 0.02f);
    EXPECT_LT(fit_error(areas), 0.005);
}

TEST(FitDirectionForm, AVerticalCylinderIsARectangleFromBesideAndNothingFromAbove) {
    PartDescription tube;
    shapes::add_tube(tube, shapes::straight_path(vec3(0), vec3(0, 4, 0), 5), std::vector<float>(5, 0.25f),
                     64);
    auto areas = projected_areas_m2(tube, true);
    DirectionForm form = fit_direction_form(areas);
    EXPECT_NEAR(form.evaluate(vec3(1, 0, 0)), 2.0f, 0.01f);
    EXPECT_NEAR(form.evaluate(vec3(0, 0.8f, 0.6f)), 1.2f, 0.01f);
    EXPECT_NEAR(form.evaluate(vec3(0, 1, 0)), 0.0f, 0.05f);
    EXPECT_LT(fit_error(areas), 0.005);
}

TEST(FitDirectionForm, ACloudOfLeavesShowsHalfItsAreaFromEverySide) {
    auto areas = projected_areas_m2(shapes::leaf_cloud(20000, 1, 0.01f, 3), false);
    DirectionForm form = fit_direction_form(areas);
    for (vec3 d : projection_directions()) EXPECT_NEAR(form.evaluate(d), 1.0f, 0.02f);
    EXPECT_LT(fit_error(areas), 0.02);
}

TEST(FitDirectionForm, AStandOfBladesFitsWithinFivePercent) {
    PartDescription blades;
    Random random(8);
    for (int i = 0; i < 2000; ++i) {
        float around = random.next_in(0, 2 * k_pi);
        vec3 lean(random.next_around(0, 0.1f), 0.5f, random.next_around(0, 0.1f));
        shapes::add_quad(blades, vec3(random.next_unit(), 0, random.next_unit()),
                         vec3(portable_cos(around), 0, portable_sin(around)) * 0.01f, lean);
    }
    auto areas = projected_areas_m2(blades, false);
    EXPECT_LT(fit_error(areas), 0.05);
    EXPECT_GT(fit_direction_form(areas).evaluate(vec3(1, 0, 0)),
              3 * fit_direction_form(areas).evaluate(vec3(0, 1, 0)));
}

TEST(FitDirectionForm, LengthsAreSeenAtTheirSine) {
    const vec3 upright[] = {vec3(0), vec3(0, 3, 0)};
    DirectionForm form = fit_direction_form(projected_lengths_m(upright));
    EXPECT_NEAR(form.evaluate(vec3(1, 0, 0)), 3.0f, 1e-3f);
    EXPECT_NEAR(form.evaluate(vec3(0, 0.8f, 0.6f)), 1.8f, 1e-2f);
    // Segments of any direction: pi / 4 of their length (ERRATA 2), not the printed half.
    std::vector<vec3> ends;
    Random random(2);
    for (int i = 0; i < 20000; ++i) {
        ends.push_back(vec3(0));
        ends.push_back(shapes::random_direction(random));
    }
    auto lengths = projected_lengths_m(ends);
    for (vec3 d : projection_directions())
        EXPECT_NEAR(fit_direction_form(lengths).evaluate(d) / 20000, k_pi / 4, 0.01f);
}

TEST(FitDirectionForm, KeepsTheMeanAndTakesNothing) {
    auto areas = projected_areas_m2(shapes::leaf_cloud(7, 1, 0.3f, 5), false);
    DirectionForm form = fit_direction_form(areas);
    double fitted = 0, measured = 0;
    for (size_t i = 0; i < areas.size(); ++i) {
        fitted += double(form.evaluate(projection_directions()[i]));
        measured += areas[i];
    }
    EXPECT_NEAR(fitted / measured, 1.0, 1e-4);
    EXPECT_EQ(fit_direction_form({}).m, (std::array<float, 6>{}));
}

}  // namespace
}  // namespace coppice
