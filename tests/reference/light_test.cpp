// The light model against values worked out by hand.
#include "tools/reference/light.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

Light simple_light() {
    Light light;
    light.direction_to_sun = vec3(0.0f, 5.0f, 0.0f);
    light.sun_color = vec3(3.0f, 2.0f, 1.0f);
    light.sky_zenith_color = vec3(0.2f, 0.4f, 0.8f);
    light.sky_horizon_color = vec3(0.6f, 0.8f, 1.0f);
    light.ground_color = vec3(0.1f, 0.2f, 0.3f);
    light.haze_color = vec3(0.5f, 0.6f, 0.7f);
    light.haze_density_per_m = 0.01f;
    return with_unit_sun(light);
}

void expect_near(vec3 got, vec3 wanted) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 1e-5f) << "channel " << c;
}

}  // namespace

TEST(ReferenceLight, OpaqueSurfacesSendColorTimesTheSunsCosine) {
    const Light light = simple_light();
    const Surface facing{vec3(0, 1, 0), vec3(0.5f, 0.25f, 0.1f), 0.5f, false};
    const Shade lit = shade(light, facing, vec3(0, 0, 1));
    expect_near(lit.sun, vec3(1.5f, 0.5f, 0.1f));
    // All of the sky's mean, half of it past the own plant.
    expect_near(lit.sky, facing.color_linear * vec3(0.4f, 0.6f, 0.9f) * 0.5f);

    Surface aslant = facing;
    aslant.normal = vec3(0.8f, 0.6f, 0.0f);
    expect_near(shade(light, aslant, vec3(0, 0, 1)).sun, lit.sun * 0.6f);

    Surface below = facing;
    below.normal = vec3(0, -1, 0);
    expect_near(shade(light, below, vec3(0, 0, 1)).sun, vec3(0.0f));
    expect_near(shade(light, below, vec3(0, 0, 1)).sky, facing.color_linear * light.ground_color * 0.5f);
}

TEST(ReferenceLight, LeavesShowTheViewersSideAndLetLightThrough) {
    const Light light = simple_light();
    const Surface leaf{vec3(0, 1, 0), vec3(0.4f, 0.9f, 0.2f), 1.0f, true};
    expect_near(shade(light, leaf, vec3(0, 1, 0)).sun, leaf.color_linear * light.sun_color);
    // From below: 1.25, 1.35 and 0.55 of the color, at most all, four fifths of it.
    expect_near(shade(light, leaf, vec3(0, -1, 0)).sun, vec3(0.5f, 1.0f, 0.11f) * 0.8f * light.sun_color);
    Surface other_side = leaf;
    other_side.normal = -leaf.normal;
    for (vec3 viewer : {vec3(0.6f, 0.8f, 0), vec3(0.6f, -0.8f, 0)}) {
        expect_near(shade(light, leaf, viewer).sun, shade(light, other_side, viewer).sun);
        expect_near(shade(light, leaf, viewer).sky, shade(light, other_side, viewer).sky);
    }
}

TEST(ReferenceLight, NoSunShinesNowhere) {
    Light light = simple_light();
    light.direction_to_sun = vec3(0.0f);
    light = with_unit_sun(light);
    const Surface leaf{vec3(0, 1, 0), vec3(0.4f), 1.0f, true};
    EXPECT_EQ(shade(light, leaf, vec3(0, 1, 0)).sun, vec3(0.0f));
    EXPECT_EQ(sky_radiance(light, vec3(0, 1, 0)), light.sky_zenith_color);
}

TEST(ReferenceLight, OpennessStandsInForShadows) {
    EXPECT_FLOAT_EQ(stand_in_sun(0.0f), 0.12f);
    EXPECT_FLOAT_EQ(stand_in_sun(0.5f), 0.34f);
    EXPECT_FLOAT_EQ(stand_in_sun(1.0f), 1.0f);
}

TEST(ReferenceLight, SkyGoesFromHorizonToZenithAndGlowsAboutTheSun) {
    const Light light = simple_light();
    expect_near(sky_radiance(light, vec3(1, 0, 0)), light.sky_horizon_color);
    expect_near(sky_radiance(light, vec3(0.6f, -0.8f, 0)), light.sky_horizon_color);
    expect_near(sky_radiance(light, vec3(0, 1, 0)), light.sky_zenith_color + light.sun_color * 0.31f);
    // sqrt(1/4) = 1/2 of the way; cosine 1/4 to the 8th is 1/65536
    const vec3 low(std::sqrt(15.0f / 16.0f), 0.25f, 0.0f);
    expect_near(sky_radiance(light, low), vec3(0.4f, 0.6f, 0.9f) + light.sun_color * (0.06f / 65536.0f));
}

TEST(ReferenceLight, HazeLetsHalfThroughAtItsHalfDistance) {
    const Light light = simple_light();
    const float half_m = 69.314718f;
    EXPECT_NEAR(clear_share(light, half_m), 0.5f, 1e-6f);
    expect_near(apply_haze(light, vec3(1.5f, 0.6f, 0.1f), half_m), vec3(1.0f, 0.6f, 0.4f));
    expect_near(apply_haze(light, vec3(1.5f), 0.0f), vec3(1.5f));
    expect_near(apply_haze(light, vec3(1.5f), 1e9f), light.haze_color);
}

}  // namespace coppice
