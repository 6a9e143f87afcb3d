// How many texels a metre gets: what the kinds are for. The table is docs/shadows.md's.
#include "tests/shadow/made_scene.h"

namespace coppice {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180.0;

struct Density {
    double near, middle, far;  // at 2, 20 and 150 m, texels a metre in the map's worst direction
};

// A sun that goes from before the viewer over the zenith to behind, as the angle between light and view says; ground
// before the viewer.
Density density_at(ShadowKind kind, double angle_deg, double yaw_deg) {
    ShadowScene scene = made_wood();
    turn_camera(scene, yaw_deg * k_degree, 0.0, 0.0);
    set_sun(scene, angle_deg * k_degree, 0.0);
    const ShadowView view = fit_shadow(kind, scene);
    auto at = [&](float z) {
        return texels_per_meter(view, scene.to_sun, scene.forward * z + vec3(0.0f, -0.3f, 0.0f));
    };
    return {at(2.0f), at(20.0f), at(150.0f)};
}

TEST(ShadowDensity, OfTheForegroundIsWhatWarpsBuy) {
    std::printf("texels a metre at 2, 20, 150 m\n%8s %-28s %-28s %-28s\n", "degrees", "uniform",
                "perspective", "light space");
    for (double yaw_deg : {0.0, 45.0})
        for (double angle_deg : {0.0, 5.0, 15.0, 30.0, 60.0, 90.0, 120.0, 150.0, 165.0, 175.0, 180.0}) {
            Density of[3];
            std::printf("%8g ", angle_deg);
            for (int i = 0; i < 3; ++i) {
                of[i] = density_at(k_shadow_kinds[i], angle_deg, yaw_deg);
                std::printf("%8.2f %8.2f %8.2f   ", of[i].near, of[i].middle, of[i].far);
            }
            std::printf("\n");
            if (angle_deg < 30.0 || angle_deg > 150.0) continue;
            EXPECT_GT(of[1].near, 1.5 * of[0].near) << angle_deg;
            EXPECT_GT(of[2].near, 1.5 * of[0].near) << angle_deg;
        }
}

}  // namespace
}  // namespace coppice
