#include "plugins/vegetation/cull/frustum.h"

#include <gtest/gtest.h>
#include "runtime/core/random.h"

namespace coppice {
namespace {

Camera some_camera(Random& random) {
    Camera camera;
    camera.yaw_rad = random.next_in(-4.0f, 4.0f);
    camera.pitch_rad = random.next_in(-1.5f, 1.5f);
    camera.vertical_fov_rad = random.next_in(0.1f, 2.5f);
    return camera;
}

bool on_picture(const Frustum& f, vec3 p, float width, float height) {
    float w = glm::dot(f.forward, p);
    if (w < f.near_m) return false;
    float x = glm::dot(f.right, p) / w * f.focal_px, y = glm::dot(f.up, p) / w * f.focal_px;
    return std::fabs(x) <= 0.5f * width && std::fabs(y) <= 0.5f * height;
}

TEST(Frustum, AxesAreARightHandedFrame) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        Camera camera = some_camera(random);
        vec3 cross = glm::cross(camera.right(), camera.up());
        EXPECT_NEAR(glm::length(cross + camera.forward()), 0.0f, 1e-5f);
        EXPECT_GE(camera.up().y, 0.0f);
    }
    Camera ahead;
    EXPECT_NEAR(ahead.forward().z, -1.0f, 1e-6f);
    EXPECT_NEAR(ahead.right().x, 1.0f, 1e-6f);
}

// A sphere or box that holds a point of the picture is never called outside.
TEST(Frustum, NothingInThePictureIsCulled) {
    Random random(2);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        Frustum f = make_frustum(some_camera(random), 1280, 720);
        vec3 p(random.next_in(-50, 50), random.next_in(-50, 50), random.next_in(-50, 50));
        if (!on_picture(f, p, 1280, 720)) continue;
        ++seen;
        float radius = random.next_in(0.0f, 20.0f);
        vec3 offset = normalize_or(vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)),
                                   vec3(1, 0, 0)) *
                      (radius * 0.999f);
        EXPECT_TRUE(sees_sphere(f, p + offset, radius + 1e-3f));
        Box box;
        box.include(p + vec3(random.next_in(-9, 0), random.next_in(-9, 0), random.next_in(-9, 0)) -
                    vec3(1e-3f));
        box.include(p + vec3(random.next_in(0, 9), random.next_in(0, 9), random.next_in(0, 9)) + vec3(1e-3f));
        EXPECT_NE(see_box(f, box), Visibility::outside);
        if (see_box(f, box) == Visibility::inside) {
            for (int c = 0; c < 8; ++c) {
                vec3 corner(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y,
                            c & 4 ? box.max.z : box.min.z);
                EXPECT_TRUE(on_picture(f, corner, 1280 * 1.001f, 720 * 1.001f));
            }
        }
    }
    EXPECT_GT(seen, 1000);
}

TEST(Frustum, CullsWhatIsWellBesideAndBehind) {
    Frustum f = make_frustum(Camera{}, 1000, 1000);
    EXPECT_FALSE(sees_sphere(f, vec3(0, 0, 10), 1.0f));
    EXPECT_FALSE(sees_sphere(f, vec3(-50, 0, -10), 1.0f));
    EXPECT_FALSE(sees_sphere(f, vec3(0, 50, -10), 1.0f));
    EXPECT_TRUE(sees_sphere(f, vec3(0, 0, -10), 1.0f));
    EXPECT_EQ(see_box(f, {vec3(-1, -1, 5), vec3(1, 1, 6)}), Visibility::outside);
    EXPECT_EQ(see_box(f, {vec3(-1, -1, -60), vec3(1, 1, -50)}), Visibility::inside);
    EXPECT_EQ(see_box(f, {vec3(-1, -1, -60), vec3(1, 1, 50)}), Visibility::across);
}

// The stretch of a small square that faces the viewer, found by projecting its corners.
double stretch_by_projection(const Frustum& f, dvec3 direction) {
    const double distance = 40.0, half = 1e-4;
    const dvec3 right(f.right), up(f.up), forward(f.forward);
    const dvec3 across =
        glm::normalize(glm::cross(direction, std::fabs(direction.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
    const dvec3 beside = glm::cross(direction, across);
    double x[4], y[4], area = 0.0;
    for (int c = 0; c < 4; ++c) {
        const dvec3 p = direction * distance + across * (c == 0 || c == 3 ? half : -half) +
                        beside * (c < 2 ? half : -half);
        x[c] = glm::dot(right, p) / glm::dot(forward, p);
        y[c] = glm::dot(up, p) / glm::dot(forward, p);
    }
    for (int c = 0; c < 4; ++c) area += 0.5 * (x[c] * y[(c + 1) % 4] - x[(c + 1) % 4] * y[c]);
    return std::sqrt(std::fabs(area)) / (2.0 * half / distance);
}

TEST(OffAxisStretch, IsWhatProjectionDoes) {
    Random random(3);
    float most = 1.0f;
    for (int i = 0; i < 2000; ++i) {
        const Frustum f = make_frustum(some_camera(random), 1280, 720);
        const float tangent_y = 360.0f / f.focal_px, tangent_x = 640.0f / f.focal_px;
        const vec3 place = (f.forward + f.right * (tangent_x * random.next_in(-1, 1)) +
                            f.up * (tangent_y * random.next_in(-1, 1))) *
                           random.next_in(0.5f, 900.0f);
        const float stretch = off_axis_stretch(f, place, glm::length(place));
        const double wanted = stretch_by_projection(f, glm::normalize(dvec3(place)));
        ASSERT_NEAR(stretch / wanted, 1.0, 1e-3) << wanted;
        most = std::max(most, stretch);
    }
    EXPECT_GT(most, 5.0f);
    const Frustum f = make_frustum(Camera{}, 1280, 720);
    EXPECT_NEAR(off_axis_stretch(f, f.forward * 17.0f, 17.0f), 1.0f, 1e-5f);
    // A plant at the border of a wide picture is a quarter larger each way: 30 degrees.
    EXPECT_NEAR(off_axis_stretch(f, f.forward * 0.8660254f + f.right * 0.5f, 1.0f), 1.24081f, 1e-4f);
}

// Plants whose crown reaches into the picture have their centres anywhere.
TEST(OffAxisStretch, IsBoundedOutsideThePicture) {
    Random random(4);
    int outside = 0;
    for (int i = 0; i < 20000; ++i) {
        const Frustum f = make_frustum(some_camera(random), 1280, 720);
        const float most = 1.0f / (f.corner_cos * std::sqrt(f.corner_cos));
        const vec3 place = vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)) *
                           std::exp(random.next_in(-40.0f, 30.0f));
        const float stretch = off_axis_stretch(f, place, glm::length(place));
        ASSERT_TRUE(std::isfinite(stretch));
        ASSERT_GE(stretch, 1.0f - 1e-5f);
        ASSERT_LE(stretch, most * (1.0f + 1e-5f));
        outside += stretch == most;
    }
    EXPECT_GT(outside, 5000);
    const Frustum f = make_frustum(Camera{}, 1280, 720);
    const float most = 1.0f / (f.corner_cos * std::sqrt(f.corner_cos));
    EXPECT_NEAR(off_axis_stretch(f, -f.forward * 5.0f, 5.0f), most, 1e-5f);
    EXPECT_NEAR(off_axis_stretch(f, f.right * 5.0f, 5.0f), most, 1e-5f);
    EXPECT_EQ(off_axis_stretch(f, vec3(0.0f), 0.0f), 1.0f);
}

}  // namespace
}  // namespace coppice
