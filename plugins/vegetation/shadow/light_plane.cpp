#include "plugins/vegetation/shadow/light_plane.h"

#include "plugins/vegetation/shadow/smallest_rectangle.h"

namespace coppice {
namespace {

bool is_finite(const dvec4& v) { return std::isfinite(v.x + v.y + v.z + v.w); }

dvec3 unit(dvec3 v) { return v / std::max(glm::length(v), 1e-300); }

}  // namespace

LightAxes view_axes(const ShadowScene& scene) {
    // Floats are unit to 1e-7, and what is left of them along the sun must be none.
    const dvec3 to_sun = unit(scene.to_sun), forward = unit(scene.forward);
    const dvec3 flat = forward - to_sun * glm::dot(forward, to_sun);
    const double sine = glm::length(flat);
    const dvec3 any = std::fabs(to_sun.y) < 0.9 ? dvec3(to_sun.z, 0.0, -to_sun.x) : dvec3(0.0, -to_sun.z, to_sun.y);
    const dvec3 along = sine > 1e-7 ? flat / sine : unit(any);
    return {glm::cross(along, to_sun), along, std::min(sine, 1.0)};
}

LightPlaneRows uniform_rows(const LightAxes& axes) {
    return {dvec4(axes.across, 0.0), dvec4(axes.along, 0.0), dvec4(0.0, 0.0, 0.0, 1.0)};
}

ShadowView fit_rows(const LightPlaneRows& rows, const ShadowScene& scene, const ReceiverHull& hull) {
    const dvec3 to_sun(scene.to_sun);
    std::array<dvec2, ReceiverHull::k_most_places> on_map;
    size_t count = 0;
    double low_depth = INFINITY, high_depth = -INFINITY, least_w = INFINITY, most_w = 0.0;
    for (const dvec3& p : hull.places()) {
        const double w = at_place(rows.w, p), depth = glm::dot(to_sun, p) / w;
        least_w = std::min(least_w, w);
        most_w = std::max(most_w, w);
        low_depth = std::min(low_depth, depth);
        high_depth = std::max(high_depth, depth);
        on_map[count++] = {at_place(rows.x, p) / w, at_place(rows.y, p) / w};
    }
    // A hull without width is shown as a millionth of a metre wide.
    const Rectangle box = smallest_rectangle(std::span(on_map).first(count), 1e-6 / most_w);
    // What is nearest to the sun of all that lies over a place, whose w it has.
    const dvec3 nearest(scene.to_sun.x > 0.0f ? scene.casters.max.x : scene.casters.min.x,
                        scene.to_sun.y > 0.0f ? scene.casters.max.y : scene.casters.min.y,
                        scene.to_sun.z > 0.0f ? scene.casters.max.z : scene.casters.min.z);
    const double height_m = glm::dot(to_sun, nearest);
    if (std::isfinite(height_m)) high_depth = std::max({high_depth, height_m / least_w, height_m / most_w});
    const double depth_margin = 1e-3 * (high_depth - low_depth) + 1e-6;
    low_depth -= depth_margin;
    high_depth += depth_margin;

    const double inner = std::max(double(scene.side_texels) - 2.0 * double(k_border_texels), 1.0);
    auto texels = [&](dvec2 axis, double low, double high) {
        const double scale = inner / (high - low);
        return (rows.x * axis.x + rows.y * axis.y) * scale + rows.w * (double(k_border_texels) - low * scale);
    };
    const dvec4 x = texels(box.axis, box.low.x, box.high.x);
    const dvec4 y = texels({-box.axis.y, box.axis.x}, box.low.y, box.high.y);
    const double per_depth = 1.0 / (high_depth - low_depth);
    const dvec4 z = dvec4(to_sun * per_depth, 0.0) - rows.w * (low_depth * per_depth);
    if (!(is_finite(x) && is_finite(y) && is_finite(z) && is_finite(rows.w) && least_w > 0.0)) return {};
    // w is about 1 where the map is coarsest.
    const double unit = 1.0 / most_w;
    return {vec4(x * unit), vec4(y * unit), vec4(z * unit), vec4(rows.w * unit), float(0.5 * least_w * unit)};
}

ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene) {
    const ReceiverHull hull(scene);
    switch (kind) {
        case ShadowKind::perspective:
            return fit_rows(perspective_rows(scene, hull), scene, hull);
        case ShadowKind::light_space:
            return fit_rows(light_space_rows(scene, hull), scene, hull);
        default:
            return fit_rows(uniform_rows(view_axes(scene)), scene, hull);
    }
}

}  // namespace coppice
