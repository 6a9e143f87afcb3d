#include "tools/coppice/bench_stability.h"

#include <algorithm>
#include <string>
#include "plugins/vegetation/shadow/shadow_view.h"
#include "runtime/core/random.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/shadow_condition.h"

namespace coppice {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180.0;
constexpr double k_angles_deg[] = {0.0, 1e-6, 1e-3, 0.1, 1.0, 5.0, 45.0, 90.0, 135.0, 179.999, 180.0};

struct Worst {
    double not_finite = 0.0, condition = 0.0, border_texels = 1e9, least_w_share = 1e9, order_errors = 0.0;
    double float_error_texels = 0.0;
    size_t maps = 0, receivers = 0;
};

ShadowScene make_scene(double angle_deg, float near_m, float far_m, double first_caster, double last_caster,
                       double yaw_deg, double pitch_deg, double roll_deg) {
    const double yaw = yaw_deg * k_degree, pitch = pitch_deg * k_degree, roll = roll_deg * k_degree;
    const dvec3 forward(-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch));
    const dvec3 level(std::cos(yaw), 0.0, -std::sin(yaw)), upright = glm::cross(level, forward);
    const dvec3 up = upright * std::cos(roll) - level * std::sin(roll);
    ShadowScene scene{};
    scene.forward = vec3(forward);
    scene.right = vec3(level * std::cos(roll) + upright * std::sin(roll));
    scene.up = vec3(up);
    scene.tangent_x = 0.77f;
    scene.tangent_y = 0.5774f;
    scene.near_m = near_m;
    scene.far_m = far_m;
    scene.receivers = {vec3(-far_m, -1.7f, -far_m), vec3(far_m, 30.0f, far_m)};
    for (double at : {first_caster, last_caster})
        for (double side : {-1.0, 1.0})
            scene.casters.include(vec3((forward * at + dvec3(scene.right) * side) * double(far_m)));
    scene.to_sun = vec3(forward * std::cos(angle_deg * k_degree) + up * std::sin(angle_deg * k_degree));
    scene.side_texels = 1024;
    return scene;
}

void check_receiver(const ShadowScene& scene, const ShadowView& view, vec3 p, Worst& worst) {
    const glm::dvec4 place(dvec3(p), 1.0);
    auto at = [](vec4 row, glm::dvec4 q) { return glm::dot(glm::dvec4(row), q); };
    const double w = at(view.row_w, place), side = scene.side_texels;
    const double column = at(view.row_x, place) / w, row = at(view.row_y, place) / w;
    worst.border_texels = std::min({worst.border_texels, column, row, side - column, side - row});
    worst.least_w_share = std::min(worst.least_w_share, w / double(view.least_w));
    const glm::dvec4 above(dvec3(p) + dvec3(scene.to_sun) * (0.01 * (1.0 + glm::length(dvec3(p)))), 1.0);
    worst.order_errors += !(at(view.row_z, above) / at(view.row_w, above) > at(view.row_z, place) / w);
    const vec4 q(p, 1.0f);
    const float w_float = glm::dot(view.row_w, q);
    const double off = std::max(std::fabs(double(glm::dot(view.row_x, q) / w_float) - column),
                                std::fabs(double(glm::dot(view.row_y, q) / w_float) - row));
    worst.float_error_texels = std::max(worst.float_error_texels, off);
    ++worst.receivers;
}

void check_map(ShadowKind kind, const ShadowScene& scene, Random& random, Worst& worst) {
    const ShadowView view = fit_shadow(kind, scene);
    ++worst.maps;
    bool finite = view.least_w > 0.0f && std::isfinite(view.least_w);
    for (vec4 row : {view.row_x, view.row_y, view.row_z, view.row_w})
        for (int i = 0; i < 4; ++i) finite = finite && std::isfinite(row[i]);
    worst.not_finite += !finite;
    if (!finite) return;
    worst.condition = std::max(worst.condition, condition_of(view));
    for (int i = 0; i < 400; ++i) {
        const float along_m = scene.near_m * std::pow(scene.far_m / scene.near_m, random.next_unit());
        const float x = scene.tangent_x * random.next_in(-1.0f, 1.0f),
                    y = scene.tangent_y * random.next_in(-1.0f, 1.0f);
        const vec3 p = (scene.forward + scene.right * x + scene.up * y) * along_m;
        if (p == glm::clamp(p, scene.receivers.min, scene.receivers.max))
            check_receiver(scene, view, p, worst);
    }
}

}  // namespace

Result<nlohmann::json> bench_stability() {
    nlohmann::json figures = nlohmann::json::array();
    const std::pair<ShadowKind, const char*> kinds[] = {{ShadowKind::uniform, "uniform"},
                                                        {ShadowKind::perspective, "perspective"},
                                                        {ShadowKind::light_space, "light space"}};
    for (auto [kind, name] : kinds) {
        Random random(1);
        Worst worst;
        for (double angle_deg : k_angles_deg)
            for (float near_m : {0.01f, 0.1f, 1.0f})
                for (float far_m : {50.0f, 1e5f})
                    for (auto [first, last] :
                         {std::pair(1.0, 1.5), std::pair(-0.5, 1.5), std::pair(-2.0, -0.1)})
                        for (dvec3 turn :
                             {dvec3(0, 0, 0), dvec3(37, -20, 0), dvec3(120, 35, 15), dvec3(-70, -89, 0)})
                            check_map(
                                kind,
                                make_scene(angle_deg, near_m, far_m, first, last, turn.x, turn.y, turn.z),
                                random, worst);
        const std::string prefix = std::string(name) + ": ";
        auto add = [&](const char* what, double value, const char* unit, std::optional<double> reach,
                       Reach side) {
            figures.push_back(to_json({prefix + what, value, unit, reach, side}));
        };
        add("maps", double(worst.maps), "", {}, Reach::at_least);
        add("receivers looked up", double(worst.receivers), "", {}, Reach::at_least);
        add("maps not finite", worst.not_finite, "", 0.0, Reach::at_most);
        add("condition", worst.condition, "", 1e5, Reach::at_most);
        // 0.01 less than the border: rows are floats.
        add("receivers' border", worst.border_texels, "texels", double(k_shadow_border_texels) - 0.01,
            Reach::at_least);
        add("receivers' w over the least", worst.least_w_share, "", 1.0, Reach::at_least);
        add("depths out of order", worst.order_errors, "", 0.0, Reach::at_most);
        add("floats against double", worst.float_error_texels, "texels", 0.02, Reach::at_most);
    }
    return nlohmann::json{{"name", "stability"}, {"figures", std::move(figures)}};
}

}  // namespace coppice
