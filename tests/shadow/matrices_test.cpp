// Every map of every kind, over angles of light and view, ranges of depth and places of casters: the laws that drawing
// with it relies on.
#include "tests/shadow/made_scene.h"

#include <algorithm>
#include "runtime/core/hash.h"
#include "tools/coppice/shadow_condition.h"

namespace coppice {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180.0;
constexpr double k_angles_deg[] = {0.0, 1e-6, 1e-3, 0.1, 1.0, 5.0, 45.0, 90.0, 135.0, 179.999, 180.0};
constexpr float k_nears_m[] = {0.01f, 0.1f, 1.0f};
constexpr float k_fars_m[] = {50.0f, 1e5f};
enum class Casters { before, across, behind };
struct Turn {
    double yaw_deg, pitch_deg, roll_deg, sun_turn_deg;
};
constexpr Turn k_turns[] = {{0, 0, 0, 0},       {0, 0, 0, 90},    {37, -20, 0, 10},
                            {120, 35, 15, 200}, {-70, -89, 0, 0}, {15, 0, 90, 45}};

Box casters_of(const ShadowScene& scene, Casters casters) {
    const float reach = scene.far_m;
    Box box;
    const float first = casters == Casters::before ? 1.0f : casters == Casters::across ? -0.5f : -2.0f;
    const float last = casters == Casters::behind ? -0.1f : 1.5f;
    for (int i = 0; i < 8; ++i)
        box.include(reach * (scene.forward * (i & 1 ? first : last) + scene.right * (i & 2 ? 1.0f : -1.0f)) +
                    vec3(0.0f, i & 4 ? 30.0f : -2.0f, 0.0f));
    return box;
}

template <class Check>
void for_each_scene(Check&& check) {
    for (double angle_deg : k_angles_deg)
        for (float near_m : k_nears_m)
            for (float far_m : k_fars_m)
                for (Casters casters : {Casters::before, Casters::across, Casters::behind})
                    for (const Turn& turn : k_turns) {
                        ShadowScene scene = made_wood();
                        scene.near_m = near_m;
                        scene.far_m = far_m;
                        scene.receivers = {vec3(-far_m, -1.7f, -far_m), vec3(far_m, 30.0f, far_m)};
                        turn_camera(scene, turn.yaw_deg * k_degree, turn.pitch_deg * k_degree,
                                    turn.roll_deg * k_degree);
                        set_sun(scene, angle_deg * k_degree, turn.sun_turn_deg * k_degree);
                        scene.casters = casters_of(scene, casters);
                        for (ShadowKind kind : k_shadow_kinds) {
                            SCOPED_TRACE(testing::Message()
                                         << name_of(kind) << ", " << angle_deg << " degrees, near " << near_m
                                         << ", far " << far_m << ", casters " << int(casters) << ", yaw "
                                         << turn.yaw_deg);
                            check(scene, fit_shadow(kind, scene));
                            if (::testing::Test::HasFatalFailure()) return;
                        }
                    }
}

TEST(ShadowMatrices, AreFiniteAndWellConditioned) {
    double worst = 0.0;
    for_each_scene([&](const ShadowScene&, const ShadowView& view) {
        ASSERT_TRUE(all_finite(view));
        const double condition = condition_of(view);
        ASSERT_LT(condition, 1e5);
        worst = std::max(worst, condition);
    });
    std::printf("condition at most %g\n", worst);
}

TEST(ShadowMatrices, HoldAllReceivers) {
    Random random(1);
    size_t checked = 0;
    double least_border = 1e9;
    for_each_scene([&](const ShadowScene& scene, const ShadowView& view) {
        for (vec3 p : receivers_of(scene, 40, random)) {
            const MapPlace place = place_on(view, p);
            ++checked;
            ASSERT_GE(place.w, 1.9 * double(view.least_w));
            const double border = std::min(
                {place.column, place.row, scene.side_texels - place.column, scene.side_texels - place.row});
            ASSERT_GE(border, double(k_shadow_border_texels) - 0.01) << p.x << " " << p.y << " " << p.z;
            least_border = std::min(least_border, border);
            ASSERT_GT(place.depth, 0.0);
            ASSERT_LE(place.depth, 1.0);
        }
    });
    EXPECT_GT(checked, 100'000u);
    std::printf("%zu receivers, border at least %.4f texels\n", checked, least_border);
}

// The order that an atomic maximum keeps: whatever stands nearer to the sun has more depth, and the same texel and w,
// wherever the caster stands.
TEST(ShadowMatrices, DepthGrowsTowardsTheSunAndTexelsStay) {
    Random random(2);
    double worst_drift = 0.0;
    for_each_scene([&](const ShadowScene& scene, const ShadowView& view) {
        for (vec3 p : receivers_of(scene, 8, random)) {
            const MapPlace receiver = place_on(view, p);
            double before = receiver.depth;
            for (double up : {1e-2, 1.0, 30.0}) {
                const double far = up * (1.0 + glm::length(dvec3(p)));
                const MapPlace caster = place_on(view, dvec3(p) + dvec3(scene.to_sun) * far);
                ASSERT_GE(caster.w, view.least_w);
                ASSERT_GT(caster.depth, before);
                before = caster.depth;
                if (up > 1.0) continue;
                const double drift = std::max(std::fabs(caster.column - receiver.column),
                                              std::fabs(caster.row - receiver.row));
                worst_drift = std::max(worst_drift, drift);
                ASSERT_LT(drift, 0.02);
            }
        }
    });
    std::printf("casters up to once their distance high drift by %.4f texels at most\n", worst_drift);
}

// A float's evaluation, as a shader does it, against double's of the same rows.
TEST(ShadowMatrices, FloatsSuffice) {
    Random random(3);
    double worst_texels = 0.0, worst_depth = 0.0;
    for_each_scene([&](const ShadowScene& scene, const ShadowView& view) {
        for (vec3 p : receivers_of(scene, 20, random)) {
            const MapPlace exact = place_on(view, p);
            const vec4 q(p, 1.0f);
            const float w = glm::dot(view.row_w, q);
            const double column = glm::dot(view.row_x, q) / w, row = glm::dot(view.row_y, q) / w;
            const double depth = glm::dot(view.row_z, q) / w;
            worst_texels =
                std::max({worst_texels, std::fabs(column - exact.column), std::fabs(row - exact.row)});
            worst_depth = std::max(worst_depth, std::fabs(depth - exact.depth));
            ASSERT_LT(worst_texels, 0.02);
            ASSERT_LT(worst_depth, 1e-5);
        }
    });
    std::printf("floats are off by %.5f texels and %.2g of the depth at most\n", worst_texels, worst_depth);
}

// Made with gcc 12 -O3; clang and every level of optimisation must give it too.
TEST(ShadowMatrices, EveryCompilerGivesTheSameBytes) {
    Random random(4);
    // Braces, because the order of a call's arguments is each compiler's own.
    auto direction = [&] {
        return vec3{random.next_in(-1.0f, 1.0f), random.next_in(-1.0f, 1.0f), random.next_in(-1.0f, 1.0f)};
    };
    std::vector<ShadowView> views;
    for (int i = 0; i < 200; ++i) {
        ShadowScene scene = made_wood();
        scene.forward = direction();
        scene.right = direction();
        scene.to_sun = direction();
        for (ShadowKind kind : k_shadow_kinds) views.push_back(fit_shadow(kind, scene));
    }
    EXPECT_EQ(hash_to_hex(hash_bytes(views.data(), views.size() * sizeof(ShadowView))), "4b770f5abd29b548");
}

TEST(ShadowMatrices, NonsenseHasAnAnswer) {
    const float bad[] = {NAN, INFINITY, -INFINITY, 0.0f, -1.0f, 1e30f, 1e-30f};
    for (ShadowKind kind :
         {ShadowKind::none, ShadowKind::uniform, ShadowKind::perspective, ShadowKind::light_space})
        for (float b : bad) {
            auto expect_finite = [&](auto&& spoil) {
                ShadowScene scene = made_wood();
                spoil(scene);
                EXPECT_TRUE(all_finite(fit_shadow(kind, scene))) << name_of(kind) << " " << b;
            };
            expect_finite([&](ShadowScene& s) { s.near_m = b; });
            expect_finite([&](ShadowScene& s) { s.far_m = b; });
            expect_finite([&](ShadowScene& s) {
                s.near_m = 10.0f;
                s.far_m = b;
            });
            expect_finite([&](ShadowScene& s) { s.tangent_x = b; });
            expect_finite([&](ShadowScene& s) { s.tangent_y = b; });
            expect_finite([&](ShadowScene& s) { s.to_sun = vec3(b); });
            expect_finite([&](ShadowScene& s) { s.to_sun = vec3(0.0f, b, 0.0f); });
            expect_finite([&](ShadowScene& s) { s.forward = vec3(b); });
            expect_finite([&](ShadowScene& s) { s.right = vec3(b); });
            expect_finite([&](ShadowScene& s) { s.up = vec3(b); });
            expect_finite([&](ShadowScene& s) { s.right = s.forward; });
            expect_finite([&](ShadowScene& s) { s.receivers.max = vec3(b); });
            expect_finite([&](ShadowScene& s) { s.receivers.min.x = b; });
            expect_finite([&](ShadowScene& s) { s.casters.max.y = b; });
            expect_finite([&](ShadowScene& s) { s.casters = {}; });
            expect_finite([&](ShadowScene& s) { s.receivers = {}; });
            expect_finite([&](ShadowScene& s) { s.receivers = {vec3(5.0f), vec3(5.0f)}; });
            expect_finite([&](ShadowScene& s) {
                s.receivers = {vec3(0.0f, 0.0f, -9.0f), vec3(0.0f, 0.0f, -9.0f)};
            });
            expect_finite([&](ShadowScene& s) { s.side_texels = 0; });
            expect_finite([&](ShadowScene& s) { s.side_texels = UINT32_MAX; });
        }
    EXPECT_TRUE(all_finite(fit_shadow(ShadowKind::perspective, ShadowScene{})));
}

}  // namespace
}  // namespace coppice
