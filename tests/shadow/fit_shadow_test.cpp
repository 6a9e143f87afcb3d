// Laws that hold for every sun, view, near and far distance and place of the casters.
#include <gtest/gtest.h>
#include <algorithm>
#include <vector>
#include "plugins/vegetation/shadow/receiver_hull.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr ShadowKind k_kinds[] = {ShadowKind::uniform, ShadowKind::perspective, ShadowKind::light_space};
constexpr float k_degree = k_pi / 180.0f;
constexpr float k_angles_deg[] = {0.0f, 1e-6f, 1e-3f, 0.1f, 1.0f, 5.0f, 45.0f, 90.0f, 135.0f, 179.999f, 180.0f};

// The sun stands by `angle` from where the viewer looks, which is level or tilted by pitch, about any axis.
ShadowScene scene_at(float angle_rad, float pitch_rad, float roll_rad, float near_m, float far_m) {
    ShadowScene scene{};
    scene.forward = vec3(0, portable_sin(pitch_rad), -portable_cos(pitch_rad));
    scene.right = vec3(1, 0, 0);
    scene.up = glm::cross(scene.right, scene.forward);
    scene.tangent_x = 0.65f;
    scene.tangent_y = 0.577f;
    scene.near_m = near_m;
    scene.far_m = far_m;
    const vec3 axis = rotate_about(scene.right, scene.forward, roll_rad);
    scene.to_sun = normalize_or(rotate_about(scene.forward, axis, angle_rad), vec3(0, 1, 0));
    scene.receivers = {vec3(-1e4f, -2.0f, -1e4f), vec3(1e4f, 20.0f, 1e4f)};
    scene.casters = scene.receivers;
    scene.side_texels = 1024;
    return scene;
}

struct OnMap {
    double column, row, depth, w;
};

OnMap on_map(const ShadowView& view, vec3 p) {
    auto at = [&](const vec4& r) { return double(r.x * p.x + r.y * p.y + r.z * p.z + r.w); };  // as the kernels do
    const double w = at(view.row_w);
    return {at(view.row_x) / w, at(view.row_y) / w, at(view.row_z) / w, w};
}

OnMap on_map_exactly(const ShadowView& view, vec3 p) {
    auto at = [&](const vec4& r) { return glm::dot(glm::dvec4(r), glm::dvec4(dvec3(p), 1.0)); };
    const double w = at(view.row_w);
    return {at(view.row_x) / w, at(view.row_y) / w, at(view.row_z) / w, w};
}

// Some of what the hull spans: its corners and places between them.
std::vector<vec3> receivers_of(const ShadowScene& scene, Random& random) {
    const ReceiverHull hull(scene);
    std::vector<vec3> places;
    for (const dvec3& p : hull.places()) places.push_back(vec3(p));
    const size_t corners = places.size();
    for (int i = 0; i < 60; ++i) {
        const vec3 a = places[random.next_below(uint32_t(corners))], b = places[random.next_below(uint32_t(corners))];
        places.push_back(a + (b - a) * random.next_unit());
    }
    return places;
}

template <class Check>
void for_all_scenes(Check&& check) {
    for (const ShadowKind kind : k_kinds)
        for (const float angle_deg : k_angles_deg)
            for (const float pitch_deg : {0.0f, -30.0f, -89.9f, -90.0f, 40.0f})
                for (const float roll_deg : {0.0f, 90.0f, 33.0f, 180.0f})
                    for (const float near_m : {0.01f, 0.1f, 1.0f})
                        for (const float far_m : {50.0f, 1e5f})
                            for (const float casters_m : {-1e3f, 0.0f, 1e3f}) {
                                ShadowScene scene = scene_at(angle_deg * k_degree, pitch_deg * k_degree,
                                                             roll_deg * k_degree, near_m, far_m);
                                // Before, across and behind the viewer.
                                if (casters_m != 0.0f) {
                                    const vec3 middle = scene.forward * casters_m;
                                    scene.casters = {middle - 500.0f, middle + 500.0f};
                                }
                                SCOPED_TRACE(testing::Message()
                                             << "kind " << int(kind) << " angle " << angle_deg << " pitch "
                                             << pitch_deg << " roll " << roll_deg << " near " << near_m
                                             << " far " << far_m << " casters " << casters_m);
                                check(kind, scene);
                                if (testing::Test::HasFailure()) return;
                            }
}

TEST(FitShadow, ReceiversLieInsideTheMapWithTheirBorder) {
    Random random(1);
    double worst_texels = 0.0;
    for_all_scenes([&](ShadowKind kind, const ShadowScene& scene) {
        const ShadowView view = fit_shadow(kind, scene);
        for (const vec4& row : {view.row_x, view.row_y, view.row_z, view.row_w})
            ASSERT_TRUE(is_finite(vec3(row)) && std::isfinite(row.w));
        ASSERT_GT(view.least_w, 0.0f);
        const double last = double(scene.side_texels) - double(k_border_texels);
        for (const vec3& p : receivers_of(scene, random)) {
            const OnMap at = on_map(view, p), exact = on_map_exactly(view, p);
            // Floats are off by less than the border is wide.
            ASSERT_GE(at.w, double(view.least_w));
            worst_texels = std::max({worst_texels, std::fabs(at.column - exact.column), std::fabs(at.row - exact.row)});
            ASSERT_GE(at.column, double(k_border_texels) - 1.0);
            ASSERT_LE(at.column, last + 1.0);
            ASSERT_GE(at.row, double(k_border_texels) - 1.0);
            ASSERT_LE(at.row, last + 1.0);
            ASSERT_GE(at.depth, 0.0);
            ASSERT_LT(at.depth, 1.0);
        }
    });
    RecordProperty("worst_rounding_texels", std::to_string(worst_texels));
    EXPECT_LT(worst_texels, 0.5);
}

// Towards the sun a place keeps its texel and its w, and its depth grows, up to the highest caster without leaving the range.
TEST(FitShadow, DepthGrowsTowardsTheSunAlongATexel) {
    Random random(2);
    for_all_scenes([&](ShadowKind kind, const ShadowScene& scene) {
        const ShadowView view = fit_shadow(kind, scene);
        for (const vec4& row : {view.row_x, view.row_y, view.row_w}) {
            const double length = double(glm::length(vec3(row)));
            ASSERT_LE(std::fabs(glm::dot(vec3(row), scene.to_sun)), 1e-6 * length + 1e-12);
        }
        const std::vector<vec3> receivers = receivers_of(scene, random);
        for (size_t i = 0; i < receivers.size(); i += 7) {
            const OnMap at = on_map_exactly(view, receivers[i]);
            double before = at.depth;
            for (const float towards_m : {0.01f, 0.1f, 1.0f, 10.0f, 100.0f}) {
                const OnMap caster = on_map_exactly(view, receivers[i] + scene.to_sun * towards_m);
                ASSERT_GT(caster.w, 0.0);
                // What rounding of the place itself may move: towards_m is a float's share of 1e5 m.
                ASSERT_NEAR(caster.column, at.column, 1.0);
                if (towards_m >= 1.0f) {
                    ASSERT_GT(caster.depth, before);
                }
                before = caster.depth;
            }
        }
    });
}

// Texels of about the same count along both axes of the picture near the viewer, and the map not folded: neighbours in space are
// neighbours on the map. Both by the determinant of the map of the plane across the sun, whose sign is that of w^3.
TEST(FitShadow, MapsAreNeverFolded) {
    Random random(3);
    for_all_scenes([&](ShadowKind kind, const ShadowScene& scene) {
        const ShadowView view = fit_shadow(kind, scene);
        const dvec3 to_sun(scene.to_sun);
        int signs = 0, count = 0;
        for (const vec3& p : receivers_of(scene, random)) {
            const OnMap at = on_map_exactly(view, p);
            const dvec3 w(vec3(view.row_w));
            const dvec3 column = (dvec3(vec3(view.row_x)) - at.column * w) / at.w,
                        row = (dvec3(vec3(view.row_y)) - at.row * w) / at.w;
            const double area = glm::dot(glm::cross(column, row), to_sun);
            ASSERT_NE(area, 0.0);
            signs += area > 0.0;
            ++count;
        }
        ASSERT_TRUE(signs == 0 || signs == count);
    });
}

// A turn of the view through the sun's direction, and through its opposite, in steps of 0.05 degrees: the map's resolution changes by no
// more than 8 times what it changes in the median, or 2 %. Perspective maps, which have the sun in the picture there, by no more than
// a factor of e^2: one reason why they are not the default.
TEST(FitShadow, TurnsThroughTheSunKeepTexelsSizes) {
    for (const ShadowKind kind : k_kinds)
        for (const float middle_deg : {0.0f, 90.0f, 180.0f})
            for (const float beside_deg : {0.0f, 0.02f}) {
                std::vector<double> changes;
                double before = 0.0;
                for (int step = -100; step <= 100; ++step) {
                    ShadowScene scene = scene_at((middle_deg + beside_deg) * k_degree, -10.0f * k_degree, 0.3f, 0.5f, 300.0f);
                    // The sun stays and the view turns.
                    const float turn = float(step) * 0.05f * k_degree;
                    const vec3 axis = normalize_or(glm::cross(scene.forward, scene.to_sun), scene.up);
                    scene.forward = rotate_about(scene.forward, axis, turn);
                    scene.right = rotate_about(scene.right, axis, turn);
                    scene.up = rotate_about(scene.up, axis, turn);
                    const ShadowView view = fit_shadow(kind, scene);
                    // Texels of a square metre across the sun, 20 m before the viewer.
                    const vec3 p = scene.forward * 20.0f;
                    const OnMap at = on_map_exactly(view, p);
                    const dvec3 w(vec3(view.row_w));
                    const double texels =
                        glm::length(glm::cross(dvec3(vec3(view.row_x)) - at.column * w,
                                               dvec3(vec3(view.row_y)) - at.row * w)) / (at.w * at.w);
                    ASSERT_GT(texels, 0.0);
                    if (step > -100) changes.push_back(std::fabs(std::log(texels / before)));
                    before = texels;
                }
                std::vector<double> sorted = changes;
                std::sort(sorted.begin(), sorted.end());
                const double median = sorted[sorted.size() / 2];
                EXPECT_LT(sorted.back(),
                          kind == ShadowKind::perspective ? 2.0 : std::max(8.0 * median, 0.02))
                    << int(kind) << " at " << middle_deg << " beside " << beside_deg << ", median " << median;
            }
}

TEST(FitShadow, WarpedMapsAreFinerNearTheViewer) {
    ShadowScene scene = scene_at(70.0f * k_degree, -5.0f * k_degree, 0.0f, 0.5f, 300.0f);
    scene.to_sun = normalize_or(vec3(0.45f, 0.75f, 0.48f), vec3(0.0f));
    auto texels_a_meter = [&](ShadowKind kind, float distance_m) {
        const ShadowView view = fit_shadow(kind, scene);
        const vec3 p = scene.forward * distance_m;
        const OnMap at = on_map_exactly(view, p);
        const dvec3 w(vec3(view.row_w));
        return std::sqrt(glm::length(glm::cross(dvec3(vec3(view.row_x)) - at.column * w,
                                                dvec3(vec3(view.row_y)) - at.row * w))) / at.w;
    };
    for (const ShadowKind kind : {ShadowKind::perspective, ShadowKind::light_space}) {
        EXPECT_GT(texels_a_meter(kind, 2.0f), 5.0 * texels_a_meter(ShadowKind::uniform, 2.0f)) << int(kind);
        EXPECT_GT(texels_a_meter(kind, 2.0f), 5.0 * texels_a_meter(kind, 100.0f)) << int(kind);
    }
    EXPECT_NEAR(texels_a_meter(ShadowKind::uniform, 2.0f), texels_a_meter(ShadowKind::uniform, 200.0f), 1e-3);
}

TEST(FitShadow, BrokenScenesGiveFiniteMaps) {
    for (const ShadowKind kind : k_kinds)
        for (int fault = 0; fault < 8; ++fault) {
            ShadowScene scene = scene_at(0.7f, -0.2f, 0.1f, 0.5f, 300.0f);
            if (fault == 0) scene.receivers = {};
            if (fault == 1) scene.casters = {};
            if (fault == 2) scene.far_m = scene.near_m;
            if (fault == 3) scene.far_m = INFINITY;
            if (fault == 4) scene.near_m = 0.0f;
            if (fault == 5) scene.tangent_x = NAN;
            if (fault == 6) scene.receivers = {vec3(3.0f), vec3(3.0f)};
            if (fault == 7) scene.to_sun = vec3(0.0f);
            const ShadowView view = fit_shadow(kind, scene);
            for (const vec4& row : {view.row_x, view.row_y, view.row_z, view.row_w})
                EXPECT_TRUE(is_finite(vec3(row)) && std::isfinite(row.w)) << int(kind) << ' ' << fault;
            EXPECT_GT(view.least_w, 0.0f);
        }
}

}  // namespace
}  // namespace coppice
