// A shadow scene as the fits compute with it: in double, and made sense of.
#pragma once
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

struct DoubleBox {
    dvec3 min, max;
    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
};

struct CheckedShadowScene {
    dvec3 right, up, forward;  // orthonormal
    double tangent_x, tangent_y;
    double near_m, far_m;  // near > 0, far > near
    DoubleBox receivers, casters;
    dvec3 to_sun;  // unit
    // The plane at right angles to the sun. It turns with the sun only: a map's texels do not turn with the camera.
    dvec3 across, along;
    double side_texels;
};

// Every value is finite; what was not, or contradicts itself, becomes a usual one. Places lie within k_farthest_m.
inline constexpr double k_farthest_m = 1e8;
CheckedShadowScene check_shadow_scene(const ShadowScene& scene);

}  // namespace coppice
