// Traced pictures whose answer geometry gives.
#include "tools/reference/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"
#include "tests/reference/small_scene.h"

namespace coppice {
namespace {

const uint32_t k_wall = surface_word(vec3(0, 0, 1), vec3(0.3f, 0.2f, 0.1f), 1.0f, false);

double sum_of(const FloatPicture& picture, int channel) {
    double sum = 0.0;
    for (size_t i = size_t(channel); i < picture.rgb.size(); i += 3) sum += double(picture.rgb[i]);
    return sum;
}

bool all_finite(const ReferencePicture& picture) {
    for (const FloatPicture* one : {&picture.shadowed, &picture.unshadowed, &picture.coverage})
        if (one->rgb.empty() ||
            !std::all_of(one->rgb.begin(), one->rgb.end(), [](float v) { return std::isfinite(v); }))
            return false;
    return true;
}

// Leaves of random size and place before the camera, many of them twice with another color: what ties are made of.
SmallScene random_thicket() {
    SmallScene small;
    small.camera.position_world = dvec3(1.0, 2.0, 3.0);
    Random random(7);
    std::vector<PackedVertex> triangles;
    for (int i = 0; i < 300; ++i) {
        const vec3 middle(random.next_around(0, 3), random.next_around(0, 3), random.next_around(0, 3));
        std::array<PackedVertex, 3> corners;
        for (PackedVertex& corner : corners)
            corner = vertex_at(middle + vec3(random.next_around(0, 0.7f), random.next_around(0, 0.7f),
                                             random.next_around(0, 0.7f)),
                               uint32_t(random.next_bits()) | 0x80000000u);
        for (int twice = 0; twice < 1 + i % 2; ++twice)
            for (PackedVertex corner : corners) {
                corner.surface ^= twice ? 0x00555000u : 0u;
                triangles.push_back(corner);
            }
    }
    const uint32_t model = small.add_model(triangles);
    small.add_plant(model, dvec3(0.0, 2.0, -6.0), pack_turn_about_y(0.3f));
    small.add_plant(model, dvec3(2.0, 1.0, -8.0), pack_turn(0.1f, 0.8f, 0.0f, 0.6f), 1.5f);
    small.add_plant(model, dvec3(2.0, 1.0, -8.0), pack_turn(0.1f, 0.8f, 0.0f, 0.6f), 1.5f);
    small.add_ground(100.0f, surface_word(vec3(0, 1, 0), vec3(0.2f), 1.0f, false),
                     surface_word(vec3(0, 1, 0), vec3(0.1f), 0.6f, false), dvec3(0.0));
    small.settings.samples_per_pixel = 4;
    return small;
}

}  // namespace

TEST(ReferenceTrace, SquareCoversExactlyItsPixels) {
    SmallScene small;
    // At distance 10 a pixel is 10/32 m wide: columns 24 to 40, rows 20 to 28.
    const float px = 10.0f / 32.0f;
    small.add_plate(vec3(-8 * px, 4 * px, -10), vec3(16 * px, 0, 0), vec3(0, 8 * px, 0), k_wall);
    const ReferencePicture picture = small.trace();
    EXPECT_EQ(picture.samples_per_pixel, 64u);
    for (uint32_t row = 0; row < 64; ++row)
        for (uint32_t column = 0; column < 64; ++column) {
            const bool inside = column >= 24 && column < 40 && row >= 20 && row < 28;
            EXPECT_EQ(pixel_of(picture.coverage, column, row), inside ? vec3(1, 0, 0) : vec3(0, 0, 1))
                << column << ", " << row;
        }
    const Shade lit = shade(small.light(), decode_surface(k_wall), vec3(0, 0, 1));
    expect_near(pixel_of(picture.shadowed, 30, 24), lit.sun + lit.sky, 1e-5f);
    expect_near(pixel_of(picture.unshadowed, 30, 24), lit.sun + lit.sky, 1e-5f);
}

TEST(ReferenceTrace, PartOfAPixelCountsByItsArea) {
    SmallScene small;
    const float px = 10.0f / 32.0f;
    // Left edge in the middle of column 24, right one at a quarter of column 40.
    small.add_plate(vec3(-7.5f * px, 0, -10), vec3(15.75f * px, 0, 0), vec3(0, 4 * px, 0), k_wall);
    const ReferencePicture picture = small.trace();
    EXPECT_FLOAT_EQ(pixel_of(picture.coverage, 24, 30).x, 0.5f);
    EXPECT_FLOAT_EQ(pixel_of(picture.coverage, 24, 30).z, 0.5f);
    EXPECT_FLOAT_EQ(pixel_of(picture.coverage, 40, 30).x, 0.25f);
    const vec3 wall = pixel_of(picture.shadowed, 30, 30), half = pixel_of(picture.shadowed, 24, 30);
    const vec3 sky = pixel_of(picture.shadowed, 23, 30);
    expect_near(half, (wall + sky) * 0.5f, 1e-3f);
}

TEST(ReferenceTrace, SlantedEdgesCoverByAreaWithinTheStrataError) {
    SmallScene small;
    small.settings.samples_per_pixel = 256;
    // A triangle of half of 20 x 10 pixels.
    const float px = 10.0f / 32.0f;
    small.add_plant(small.add_model({vertex_at(vec3(-9.3f * px, -3.1f * px, -10), k_wall),
                                     vertex_at(vec3(10.7f * px, -3.1f * px, -10), k_wall),
                                     vertex_at(vec3(4.2f * px, 6.9f * px, -10), k_wall)}),
                    dvec3(0.0));
    EXPECT_NEAR(sum_of(small.trace().coverage, 0), 100.0, 0.1);
}

TEST(ReferenceTrace, NearIsADepthNotADistance) {
    SmallScene small;
    small.camera.near_m = 1.0f;
    small.settings.samples_per_pixel = 1;
    small.add_plate(vec3(-9, -9, -0.99f), vec3(18, 0, 0), vec3(0, 18, 0), k_wall);
    EXPECT_EQ(sum_of(small.trace().coverage, 0), 0.0);
    SmallScene beyond;
    beyond.camera.near_m = 1.0f;
    beyond.settings.samples_per_pixel = 1;
    beyond.add_plate(vec3(-9, -9, -1.01f), vec3(18, 0, 0), vec3(0, 18, 0), k_wall);
    EXPECT_EQ(sum_of(beyond.trace().coverage, 0), 64.0 * 64.0);
}

TEST(ReferenceTrace, SkyAloneIsTheSkyOfTheLightModel) {
    SmallScene small;
    small.camera.pitch_rad = 0.4f;
    const ReferencePicture picture = small.trace();
    EXPECT_EQ(sum_of(picture.coverage, 2), 64.0 * 64.0);
    EXPECT_EQ(picture.shadowed.rgb, picture.unshadowed.rgb);
    // The middle of the picture, where four pixels meet, looks along the view axis.
    const vec3 middle = (pixel_of(picture.shadowed, 31, 31) + pixel_of(picture.shadowed, 32, 31) +
                         pixel_of(picture.shadowed, 31, 32) + pixel_of(picture.shadowed, 32, 32)) *
                        0.25f;
    expect_near(middle, sky_radiance(small.light(), small.camera.forward()), 1e-3f);
}

TEST(ReferenceTrace, ShadowFallsWhereGeometrySays) {
    // From 20 m straight down, 6.4 pixels a metre. A plate of 2 x 2 m hangs at 5 m; the sun stands at 45 degrees in +x,
    // so its shadow lies 5 m towards -x, on [-1, 1] x [-1, 1].
    SmallScene small;
    small.settings.width = small.settings.height = 128;
    small.camera.position_world = dvec3(0.0, 20.0, 0.0);
    small.camera.pitch_rad = -k_pi * 0.5f;
    small.camera.vertical_fov_rad = 2.0f * portable_atan2(1.0f, 2.0f);
    small.scene.light.direction_to_sun = vec3(1, 1, 0);
    const uint32_t bare = surface_word(vec3(0, 1, 0), vec3(0.25f, 0.3f, 0.1f), 1.0f, false);
    const uint32_t drawn = surface_word(vec3(0, 1, 0), vec3(0.1f, 0.15f, 0.05f), 0.4f, false);
    small.add_ground(50.0f, bare, drawn, dvec3(0.0));
    small.add_plate(vec3(4, 5, -1), vec3(0, 0, 2), vec3(2, 0, 0), k_wall);
    const ReferencePicture picture = small.trace();

    const Shade ground = shade(small.light(), decode_surface(bare), vec3(0, 1, 0));
    auto at = [&](float x, float z) {
        return pixel_of(picture.shadowed, uint32_t(64.0f + 6.4f * x), uint32_t(64.0f + 6.4f * z));
    };
    for (vec2 inside : {vec2(0, 0), vec2(-0.7f, 0.7f), vec2(0.7f, -0.7f)})
        expect_near(at(inside.x, inside.y), ground.sky, 1e-5f);
    for (vec2 outside : {vec2(-1.4f, 0), vec2(1.4f, 0), vec2(0, -1.4f), vec2(0, 1.4f), vec2(-8, 8)})
        expect_near(at(outside.x, outside.y), ground.sun + ground.sky, 1e-5f);
    double dark_px = 0.0;
    for (uint32_t row = 0; row < 128; ++row)
        for (uint32_t column = 0; column < 84; ++column)
            dark_px +=
                double((ground.sun + ground.sky - pixel_of(picture.shadowed, column, row)).y / ground.sun.y);
    EXPECT_NEAR(dark_px, 4.0 * 6.4 * 6.4, 0.5);

    // Without shadows, the ground has its darkened color and openness everywhere.
    const Surface stand_in = decode_surface(drawn);
    const Shade drawn_ground = shade(small.light(), stand_in, vec3(0, 1, 0));
    for (vec2 place : {vec2(0, 0), vec2(-8, 8)})
        expect_near(
            pixel_of(picture.unshadowed, uint32_t(64.0f + 6.4f * place.x), uint32_t(64.0f + 6.4f * place.y)),
            drawn_ground.sun * stand_in_sun(stand_in.openness) + drawn_ground.sky, 1e-5f);
    EXPECT_EQ(pixel_of(picture.coverage, 64, 64), vec3(0, 1, 0));
}

TEST(ReferenceTrace, LeafLitFromBehindGlowsUnlessItsSunnySideIsHidden) {
    const uint32_t leaf = surface_word(vec3(0, 0, 1), vec3(0.1f, 0.4f, 0.05f), 1.0f, true);
    SmallScene small;
    small.settings.samples_per_pixel = 4;
    small.scene.light.direction_to_sun = vec3(0, 0.6f, -0.8f);  // behind the leaf, as the viewer sees it
    small.add_plate(vec3(-2, -2, -5), vec3(4, 0, 0), vec3(0, 4, 0), leaf);
    // On the viewer's side, above the picture: hides no sun from the leaf's other side.
    small.add_plate(vec3(-20, 3, -4.9f), vec3(40, 0, 0), vec3(0, 0, 9), k_wall);
    const Shade lit = shade(small.light(), decode_surface(leaf), vec3(0, 0, 1));
    ASSERT_GT(lit.sun.y, 0.1f);
    expect_near(pixel_of(small.trace().shadowed, 32, 32), lit.sun + lit.sky, 1e-5f);

    // A wall behind it, in front of the sun.
    small.add_plate(vec3(-20, -20, -6), vec3(40, 0, 0), vec3(0, 40, 0), k_wall);
    const ReferencePicture hidden = small.trace();
    expect_near(pixel_of(hidden.shadowed, 32, 32), lit.sky, 1e-5f);
    expect_near(pixel_of(hidden.unshadowed, 32, 32), lit.sun + lit.sky, 1e-5f);
}

TEST(ReferenceTrace, SurfacesDoNotShadeThemselvesFarOrNear) {
    for (float distance_m : {0.2f, 3.0f, 700.0f, 20000.0f}) {
        SmallScene small;
        small.scene.light.direction_to_sun = vec3(0.5f, 0.3f, 0.1f);  // grazing
        const uint32_t word = surface_word(vec3(0, 0, 1), vec3(0.3f), 1.0f, false);
        const float side_m = 4.0f * distance_m;
        small.add_plate(vec3(-0.5f * side_m, -0.5f * side_m, 0), vec3(side_m, 0, 0), vec3(0, side_m, 0),
                        word);
        small.scene.tiles[0].tile.origin_world = dvec3(0.1, 0.2, -double(distance_m));
        const Shade lit = shade(small.light(), decode_surface(word), vec3(0, 0, 1));
        const ReferencePicture picture = small.trace();
        double share = 0.0;
        for (size_t i = 0; i < picture.shadowed.rgb.size(); i += 3)
            share += double((picture.shadowed.rgb[i] - lit.sky.x) / lit.sun.x) / (64.0 * 64.0);
        EXPECT_NEAR(share, 1.0, 1e-4) << distance_m << " m";
    }
}

TEST(ReferenceTrace, TurnedAndScaledPlantsProjectWhereTheyShould) {
    struct Case {
        float x, y, z, w, scale;
    };
    for (Case c : {Case{0, 0, 0, 1, 1}, Case{0, 0.6f, 0, 0.8f, 2}, Case{0.3f, -0.5f, 0.1f, 0.8f, 0.7f},
                   Case{-0.05f, 0.9f, 0.07f, 0.4f, 1.3f}}) {
        const vec3 place(1.3f, 2.1f, -0.4f);
        SmallScene small;
        small.settings.width = 480;  // not square
        small.settings.height = 320;
        small.settings.samples_per_pixel = 64;
        small.camera.position_world = dvec3(10.0, 3.0, -2.0);
        small.camera.yaw_rad = 0.7f;
        small.camera.pitch_rad = -0.2f;
        const float e = 0.1f / c.scale;  // a small octahedron: looks alike from all sides
        std::vector<PackedVertex> ball;
        for (float sx : {-e, e})
            for (float sy : {-e, e})
                for (float sz : {-e, e})
                    for (vec3 tip : {vec3(sx, 0, 0), vec3(0, sy, 0), vec3(0, 0, sz)})
                        ball.push_back(vertex_at(place + tip, k_wall));
        const dvec3 foot(6.0, 1.0, -8.0);
        small.add_plant(small.add_model(ball), foot, pack_turn(c.x, c.y, c.z, c.w), c.scale);

        // By the quaternion itself, in double: v + 2 q x (q x v + w v).
        const double n =
            std::sqrt(double(c.x) * c.x + double(c.y) * c.y + double(c.z) * c.z + double(c.w) * c.w);
        const dvec3 q(c.x / n, c.y / n, c.z / n), v(place);
        const dvec3 turned = v + 2.0 * glm::cross(q, glm::cross(q, v) + (c.w / n) * v);
        const dvec3 seen = foot + turned * double(c.scale) - small.camera.position_world;
        const double sin_yaw = std::sin(0.7), cos_yaw = std::cos(0.7), sin_pitch = std::sin(-0.2),
                     cos_pitch = std::cos(-0.2);
        const dvec3 forward(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch),
            right(cos_yaw, 0, -sin_yaw);
        const dvec3 up = glm::cross(right, forward);
        const double depth = glm::dot(seen, forward);
        const double column = 240.0 + 160.0 * glm::dot(seen, right) / depth;
        const double row = 160.0 - 160.0 * glm::dot(seen, up) / depth;
        ASSERT_TRUE(column > 9 && column < 471 && row > 9 && row < 311) << column << ", " << row;

        const ReferencePicture picture = small.trace();
        double mass = 0.0, column_sum = 0.0, row_sum = 0.0;
        for (uint32_t y = 0; y < 320; ++y)
            for (uint32_t x = 0; x < 480; ++x) {
                const double share = double(pixel_of(picture.coverage, x, y).x);
                mass += share;
                column_sum += share * (x + 0.5);
                row_sum += share * (y + 0.5);
            }
        ASSERT_GT(mass, 3.0);
        EXPECT_NEAR(column_sum / mass, column, 0.03);
        EXPECT_NEAR(row_sum / mass, row, 0.03);
    }
}

TEST(ReferenceTrace, NormalsTurnWithThePlantAndColorsBlendOverATriangle) {
    SmallScene small;
    small.scene.light.direction_to_sun = vec3(0, 0, 1);
    // Lies flat facing up in its own space; a quarter turn about x makes it face the viewer.
    const vec3 up(0, 1, 0);
    const uint32_t words[3] = {surface_word(up, vec3(1, 0, 0), 1.0f, false),
                               surface_word(up, vec3(0, 1, 0), 1.0f, false),
                               surface_word(up, vec3(0, 0, 1), 1.0f, false)};
    small.add_plant(small.add_model({vertex_at(vec3(-6, 0, 4), words[0]), vertex_at(vec3(6, 0, 4), words[1]),
                                     vertex_at(vec3(0, 0, -8), words[2])}),
                    dvec3(0.0, 0.0, -10.0), pack_turn(std::sqrt(0.5f), 0, 0, std::sqrt(0.5f)));
    Surface mean = decode_surface(words[0]);
    mean.color_linear = vec3(1.0f / 3.0f);
    mean.normal = vec3(0, 0, 1);
    const ReferencePicture picture = small.trace();
    vec3 middle(0.0f);
    for (uint32_t y : {31u, 32u})
        for (uint32_t x : {31u, 32u}) middle += pixel_of(picture.shadowed, x, y) * 0.25f;
    const Shade lit = shade(small.light(), mean, vec3(0, 0, 1));
    expect_near(middle, lit.sun + lit.sky, 0.03f);
    const vec3 left = pixel_of(picture.shadowed, 17, 42), top = pixel_of(picture.shadowed, 32, 12);
    EXPECT_GT(left.x, 3.0f * left.y);
    EXPECT_GT(top.z, 3.0f * top.x);
}

TEST(ReferenceTrace, HazeGrowsWithTheDistanceAlongTheRay) {
    SmallScene small;
    small.scene.light.haze_density_per_m = 0.05f;
    small.add_plate(vec3(-40, -40, -20), vec3(80, 0, 0), vec3(0, 80, 0), k_wall);
    const ReferencePicture picture = small.trace();
    const Light light = small.light();
    for (uint32_t column : {4u, 32u, 60u}) {
        const vec3 along((float(column) + 0.5f - 32.0f) / 32.0f, 0.5f / 32.0f, -1.0f);
        const Shade lit = shade(light, decode_surface(k_wall), vec3(0, 0, 1));
        expect_near(pixel_of(picture.shadowed, column, 31),
                    apply_haze(light, lit.sun + lit.sky, 20.0f * glm::length(along)), 2e-3f);
    }
}

TEST(ReferenceTrace, SameBytesOnAnyNumberOfThreads) {
    const SmallScene small = random_thicket();
    set_thread_limit(1);
    const ReferencePicture one = small.trace();
    set_thread_limit(2);
    const ReferencePicture two = small.trace();
    set_thread_limit(0);
    EXPECT_GT(sum_of(one.coverage, 0), 200.0);
    EXPECT_GT(sum_of(one.coverage, 1), 200.0);
    EXPECT_NE(one.shadowed.rgb, one.unshadowed.rgb);
    EXPECT_EQ(one.shadowed.rgb, two.shadowed.rgb);
    EXPECT_EQ(one.unshadowed.rgb, two.unshadowed.rgb);
    EXPECT_EQ(one.coverage.rgb, two.coverage.rgb);
}

TEST(ReferenceTrace, FarFromTheWorldsOriginThePictureIsTheSame) {
    SmallScene small = random_thicket();
    const ReferencePicture here = small.trace();
    const dvec3 far(1e6, 500.0, -3e6);
    small.camera.position_world += far;
    for (SceneTile& tile : small.scene.tiles) tile.tile.origin_world += far;
    small.add_ground(100.0f, small.bare->vertices()[0].surface, small.scene.terrain->vertices()[0].surface,
                     far);
    const ReferencePicture there = small.trace();
    EXPECT_EQ(here.shadowed.rgb, there.shadowed.rgb);
    EXPECT_EQ(here.coverage.rgb, there.coverage.rgb);
}

TEST(ReferenceTrace, SharesAddUpAndNothingIsNaN) {
    SmallScene small = random_thicket();
    small.scene.light.direction_to_sun = vec3(0.0f);
    const ReferencePicture picture = small.trace();
    EXPECT_TRUE(all_finite(picture));
    for (size_t i = 0; i < picture.coverage.rgb.size(); i += 3)
        EXPECT_FLOAT_EQ(picture.coverage.rgb[i] + picture.coverage.rgb[i + 1] + picture.coverage.rgb[i + 2],
                        1.0f);
}

TEST(ReferenceTrace, DegenerateTrianglesAndEmptyModelsChangeNothing) {
    SmallScene small = random_thicket();
    const ReferencePicture before = small.trace();
    std::vector<PackedVertex> nothing;
    for (vec3 p : {vec3(0, 0, 0), vec3(0, 0, 0), vec3(0, 0, 0), vec3(-1, 0, 0), vec3(0, 0, 0), vec3(1, 0, 0)})
        nothing.push_back(vertex_at(p, 0xffffffffu));
    small.add_plant(small.add_model(nothing), dvec3(0.0, 2.0, -3.0));
    small.add_plant(small.add_model({}), dvec3(0.0, 2.0, -3.0));
    const ReferencePicture after = small.trace();
    EXPECT_TRUE(all_finite(after));
    EXPECT_EQ(before.coverage.rgb, after.coverage.rgb);
    EXPECT_EQ(before.shadowed.rgb, after.shadowed.rgb);
}

TEST(ReferenceTrace, CountsTrianglesOfAllInstancesAndTheGround) {
    const SmallScene small = random_thicket();
    auto rays = small.create();
    ASSERT_TRUE(rays);
    EXPECT_EQ((*rays)->triangle_count(), 3u * 450u + 2u);
}

TEST(ReferenceTrace, SamplesAreRoundedUpToASquare) {
    SmallScene small;
    small.settings.width = small.settings.height = 2;
    for (auto [asked, taken] : {std::pair(1u, 1u), {2u, 4u}, {60u, 64u}, {64u, 64u}, {65u, 81u}}) {
        small.settings.samples_per_pixel = asked;
        EXPECT_EQ(small.trace().samples_per_pixel, taken);
    }
}

TEST(ReferenceTrace, WhatCannotBeMeantIsRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    auto refused = [](const char* what, auto change) {
        SmallScene small = random_thicket();
        change(small);
        auto picture = small.try_trace();
        ASSERT_FALSE(picture) << what;
        EXPECT_EQ(picture.error().id, ErrorId::value_out_of_range) << what;
        EXPECT_FALSE(picture.error().place.empty() || picture.error().remedy.empty()) << what;
    };
    refused("no width", [](SmallScene& s) { s.settings.width = 0; });
    refused("no height", [](SmallScene& s) { s.settings.height = 0; });
    refused("too wide", [](SmallScene& s) { s.settings.width = k_picture_side_limit + 1; });
    refused("no samples", [](SmallScene& s) { s.settings.samples_per_pixel = 0; });
    refused("too many samples", [](SmallScene& s) { s.settings.samples_per_pixel = UINT32_MAX; });
    refused("camera nowhere", [&](SmallScene& s) { s.camera.position_world.y = double(nan); });
    refused("camera without direction", [&](SmallScene& s) { s.camera.yaw_rad = inf; });
    refused("no near plane", [](SmallScene& s) { s.camera.near_m = 0.0f; });
    refused("light", [&](SmallScene& s) { s.scene.light.sun_color.x = inf; });
    refused("haze", [&](SmallScene& s) { s.scene.light.haze_density_per_m = nan; });
    refused("a model missing", [](SmallScene& s) { s.models.pop_back(); });
    refused("a model unknown", [](SmallScene& s) { s.scene.plant_models[1].model = 9; });
    refused("turns missing", [](SmallScene& s) { s.scene.turns.pop_back(); });
    refused("a tile too long", [](SmallScene& s) { s.scene.tiles[2].plant_count = 2; });
    refused("a tile nowhere", [&](SmallScene& s) { s.scene.tiles[0].tile.origin_world.x = double(inf); });
    refused("a plant nowhere", [&](SmallScene& s) { s.scene.positions[0].z_tile = nan; });
    refused("a plant of no size", [](SmallScene& s) { s.scene.positions[0].scale = 0.0f; });
    refused("a vertex nowhere", [&](SmallScene& s) { s.models[0][4].y_plant = nan; });
    refused("no bare terrain", [](SmallScene& s) { s.bare = nullptr; });
    refused("no terrain", [](SmallScene& s) { s.scene.terrain = nullptr; });
}

}  // namespace coppice
