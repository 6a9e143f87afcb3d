#include "plugins/vegetation/shadow/receiver_hull.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <vector>
#include "runtime/core/random.h"

namespace coppice {
namespace {

ShadowScene some_scene(Random& random) {
    ShadowScene scene{};
    scene.forward = normalize_or(vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)), vec3(1, 0, 0));
    scene.right = perpendicular_to(scene.forward);
    scene.up = glm::cross(scene.right, scene.forward);
    scene.tangent_x = random.next_in(0.1f, 2.0f);
    scene.tangent_y = random.next_in(0.1f, 2.0f);
    scene.near_m = random.next_in(0.1f, 5.0f);
    scene.far_m = scene.near_m + random.next_in(10.0f, 100.0f);
    for (int i = 0; i < 2; ++i)
        scene.receivers.include(
            vec3(random.next_in(-50, 50), random.next_in(-50, 50), random.next_in(-50, 50)));
    scene.casters = scene.receivers;
    scene.to_sun = vec3(0, 1, 0);
    scene.side_texels = 256;
    return scene;
}

bool is_seen(const ShadowScene& scene, vec3 p, float slack_m) {
    const float distance = glm::dot(scene.forward, p);
    return distance >= scene.near_m - slack_m && distance <= scene.far_m + slack_m &&
           std::fabs(glm::dot(scene.right, p)) <= distance * scene.tangent_x + slack_m &&
           std::fabs(glm::dot(scene.up, p)) <= distance * scene.tangent_y + slack_m &&
           glm::all(glm::greaterThanEqual(p, scene.receivers.min - slack_m)) &&
           glm::all(glm::lessThanEqual(p, scene.receivers.max + slack_m));
}

// In every direction the hull reaches as far as what is seen, and no farther.
TEST(ReceiverHull, ReachesAsFarAsWhatIsSeen) {
    Random random(3);
    int full = 0;
    for (int i = 0; i < 300; ++i) {
        const ShadowScene scene = some_scene(random);
        std::vector<vec3> seen;
        for (int k = 0; k < 3000; ++k) {
            const vec3 share(random.next_unit(), random.next_unit(), random.next_unit());
            const vec3 p = scene.receivers.min + share * scene.receivers.size();
            if (is_seen(scene, p, 0.0f)) seen.push_back(p);
        }
        const ReceiverHull hull(scene);
        if (seen.size() < 100) continue;
        ++full;
        for (const dvec3& p : hull.places()) EXPECT_TRUE(is_seen(scene, vec3(p), 1e-3f));
        for (int k = 0; k < 20; ++k) {
            const vec3 direction = normalize_or(
                vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)), vec3(1, 0, 0));
            double reach = -INFINITY, of_hull = -INFINITY;
            for (const vec3& p : seen) reach = std::max(reach, double(glm::dot(p, direction)));
            for (const dvec3& p : hull.places()) of_hull = std::max(of_hull, glm::dot(p, dvec3(direction)));
            EXPECT_GE(of_hull, reach - 1e-3);
        }
    }
    EXPECT_GT(full, 50);
}

TEST(ReceiverHull, IsAPlaceWhereNothingIsSeen) {
    Random random(4);
    ShadowScene scene = some_scene(random);
    scene.receivers = {};
    EXPECT_EQ(ReceiverHull(scene).places().size(), 1u);
    scene.receivers = {scene.forward * -20.0f, scene.forward * -10.0f};  // behind
    EXPECT_EQ(ReceiverHull(scene).places().size(), 1u);
    scene.near_m = NAN;
    ASSERT_EQ(ReceiverHull(scene).places().size(), 1u);
    EXPECT_EQ(ReceiverHull(scene).places()[0], dvec3(0.0));
}

}  // namespace
}  // namespace coppice
