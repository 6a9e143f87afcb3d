// Light-space perspective shadow maps (Wimmer, Scherzer and Purgathofer 2004): seen from the sun, w grows along the view from a
// centre n before the nearest receiver on, so that texels grow with the distance from the viewer.
#include "plugins/vegetation/shadow/light_plane.h"

namespace coppice {

LightPlaneRows light_space_rows(const ShadowScene& scene, const ReceiverHull& hull) {
    const LightAxes axes = view_axes(scene);
    double first = INFINITY, last = -INFINITY;
    for (const dvec3& p : hull.places()) {
        const double along = glm::dot(axes.along, p);
        first = std::min(first, along);
        last = std::max(last, along);
    }
    const double depth = last - first;  // d
    LightPlaneRows rows = uniform_rows(axes);
    // n of ERRATA 6: without end where the viewer looks along the sun's rays, which is the uniform map.
    const double sine = axes.sine, near_m = double(scene.near_m);
    const double warp = sine * sine / (near_m + std::sqrt(near_m * (near_m + depth * sine * sine)));  // 1 / n
    if (!(depth > 0.0 && std::isfinite(warp))) return rows;
    rows.w = dvec4(axes.along * warp, 1.0 - first * warp);
    return rows;
}

}  // namespace coppice
