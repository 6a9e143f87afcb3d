// A camera that turns slowly sees the map move slowly: nothing flips or flashes, least of all where the view passes
// through the sun, the sun's opposite and the right angle to it.
#include "tests/shadow/made_scene.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180.0;

struct Moves {
    double median, most;
};

// Of up to twelve receivers that stand before the camera all the time, over 4 degrees in steps of 0.05 through the
// angle. What moves is the place in the map, in texels a step.
template <class SetScene>
Moves turn_through(ShadowKind kind, SetScene&& set_scene) {
    std::vector<double> moves;
    std::vector<MapPlace> before;
    for (int step = -40; step <= 40; ++step) {
        ShadowScene scene = made_wood();
        set_scene(scene, 0.05 * step * k_degree);
        static const vec3 k_offsets[] = {{0, 0, 1}, {0.2f, 0, 1}, {-0.2f, 0.1f, 1}, {0, -0.2f, 1}};
        ShadowScene middle = made_wood();
        set_scene(middle, 0.0);
        const ShadowView view = fit_shadow(kind, scene);
        std::vector<MapPlace> places;
        for (vec3 o : k_offsets)
            for (float far_m : {1.5f, 4.0f, 60.0f}) {
                const vec3 p = (middle.forward + middle.right * o.x + middle.up * o.y) * far_m;
                const Box& b = middle.receivers;
                if (p == glm::clamp(p, b.min, b.max)) places.push_back(place_on(view, p));
            }
        for (size_t i = 0; i < before.size(); ++i)
            moves.push_back(std::hypot(places[i].column - before[i].column, places[i].row - before[i].row));
        before = places;
    }
    EXPECT_GT(moves.size(), 80u);
    std::sort(moves.begin(), moves.end());
    return {moves[moves.size() / 2], moves.back()};
}

constexpr double k_most_times_median = 16.0;
constexpr double k_most_texels = 8.0;  // where the median is next to nothing

TEST(ShadowTurns, ThroughEverySingularAngleMoveTheMapSteadily) {
    double worst = 0.0;
    for (ShadowKind kind : k_shadow_kinds)
        for (double elevation_deg : {5.0, 20.0, 45.0, 70.0, 90.0})
            for (double angle_deg : {0.0, 90.0, 180.0})
                for (double beside_deg : {0.0, 0.01, 1.0, 5.0})
                    for (bool pitching : {true, false}) {
                        const double e = elevation_deg * k_degree;
                        auto set_scene = [&](ShadowScene& scene, double turn) {
                            // The view whose angle to the sun is asked for: in the sun's own upright plane.
                            scene.to_sun = vec3(float(0.0), float(std::sin(e)), float(-std::cos(e)));
                            double pitch = e + (angle_deg == 90.0 ? -90.0 * k_degree : 0.0), yaw = 0.0;
                            if (angle_deg == 180.0) {
                                pitch = -e;
                                yaw = 180.0 * k_degree;
                            }
                            yaw += beside_deg * k_degree;
                            if (pitching)
                                pitch += turn;
                            else
                                yaw += turn;
                            turn_camera(scene, yaw, pitch, 0.0);
                        };
                        const Moves moves = turn_through(kind, set_scene);
                        const double times =
                            moves.most / std::max(moves.median, k_most_texels / k_most_times_median);
                        worst = std::max(worst, times);
                        EXPECT_LE(times, k_most_times_median)
                            << name_of(kind) << ", sun " << elevation_deg << " degrees high, through "
                            << angle_deg << ", beside by " << beside_deg
                            << (pitching ? ", pitching: " : ", turning: ") << moves.most << " texels, median "
                            << moves.median;
                    }
    std::printf("the largest move is %.2f times the median\n", worst);
}

}  // namespace
}  // namespace coppice
