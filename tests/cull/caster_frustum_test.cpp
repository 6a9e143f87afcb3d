#include "plugins/vegetation/cull/caster_frustum.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "runtime/core/random.h"

namespace coppice {
namespace {

vec3 some_direction(Random& random) {
    return normalize_or(vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)),
                        vec3(0, 1, 0));
}

// By how much the shadow of a place can lie inside of what is seen up to far_m, at best along the sun's ray; < 0: outside.
// The distance to the nearest plane of the view, in m: a piecewise linear, concave function along the ray.
double shadow_inside_m(const Frustum& view, dvec3 place, dvec3 to_sun, double far_m) {
    auto inside_m = [&](double along_m) {
        const dvec3 at = place - to_sun * along_m;
        double least = far_m - glm::dot(dvec3(view.forward), at);
        for (uint32_t i = 1; i < view.plane_count; ++i)
            least = std::min(least, glm::dot(dvec3(view.planes[i]), at));
        return least;
    };
    double low = 0.0, high = 1e4;
    for (int i = 0; i < 200; ++i) {
        const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        if (inside_m(a) < inside_m(b))
            low = a;
        else
            high = b;
    }
    return std::max(inside_m(0.0), inside_m(low));
}

TEST(CasterFrustum, HoldsWhatThrowsShadowsIntoThePictureAndNothingElse) {
    Random random(7);
    int inside = 0, outside = 0;
    for (int i = 0; i < 400; ++i) {
        Camera camera;
        camera.yaw_rad = random.next_in(-4.0f, 4.0f);
        camera.pitch_rad = random.next_in(-1.5f, 1.5f);
        camera.vertical_fov_rad = random.next_in(0.2f, 2.2f);
        const Frustum view = make_frustum(camera, 1280, 720);
        const vec3 to_sun = some_direction(random);
        const float far_m = random.next_in(20.0f, 200.0f);
        const Frustum casters = make_caster_frustum(view, to_sun, far_m);
        ASSERT_LE(casters.plane_count, Frustum::k_most_planes);
        for (int k = 0; k < 100; ++k) {
            const vec3 place = some_direction(random) * random.next_in(0.0f, 300.0f);
            const double inside_m = shadow_inside_m(view, place, to_sun, far_m);
            if (std::fabs(inside_m) < 0.02) continue;  // rounding decides
            ASSERT_EQ(sees_sphere(casters, place, 0.0f), inside_m > 0.0)
                << i << ": " << inside_m << " m inside, sun " << to_sun.x << ' ' << to_sun.y << ' ' << to_sun.z;
            ++(inside_m > 0.0 ? inside : outside);
        }
    }
    EXPECT_GT(inside, 4000);
    EXPECT_GT(outside, 4000);
}

// Straight along, across and against the view, and along its edges: all planes are finite, and the view itself is inside.
TEST(CasterFrustum, HoldsTheViewForEverySun) {
    const Frustum view = make_frustum(Camera{}, 800, 600);
    const vec3 corner = view.forward + view.right * (400.0f / view.focal_px) + view.up * (300.0f / view.focal_px);
    for (const vec3 direction : {view.forward, -view.forward, view.up, -view.up, view.right, -view.right, corner,
                                 -corner, corner - view.up * 0.3f}) {
        const Frustum casters = make_caster_frustum(view, glm::normalize(direction), 50.0f);
        ASSERT_GT(casters.plane_count, 2u);
        for (uint32_t i = 0; i < casters.plane_count; ++i) {
            EXPECT_TRUE(is_finite(vec3(casters.planes[i])) && std::isfinite(casters.planes[i].w));
            EXPECT_NEAR(glm::length(vec3(casters.planes[i])), 1.0f, 1e-5f);
        }
        for (const float distance : {0.2f, 10.0f, 49.0f})
            for (const float x : {-0.99f, 0.0f, 0.99f})
                for (const float y : {-0.99f, 0.99f})
                    EXPECT_TRUE(sees_sphere(casters,
                                            (view.forward + view.right * (x * 400.0f / view.focal_px) +
                                             view.up * (y * 300.0f / view.focal_px)) *
                                                distance,
                                            1e-3f));
    }
}

}  // namespace
}  // namespace coppice
