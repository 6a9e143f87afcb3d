// Where a shadow map looks from, and how it is fitted to what is seen.
//
// The sun's rays are parallel, so every map, however it is warped, is a projective map of the plane across the sun's direction: along a
// ray neither column nor row nor w changes, only depth. So rows x, y and w are at right angles to the sun, which leaves no case
// in which the light is behind a projection, and depth grows towards the sun wherever z does (DESIGN 3, ERRATA 6).
#pragma once
#include "plugins/vegetation/lod/settings.h"
#include "runtime/core/math.h"

namespace coppice {

// What a map is to show. All relative to the viewer, m.
struct ShadowScene {
    vec3 right, up, forward;      // the camera's axes, unit
    float tangent_x, tangent_y;   // of half its angles of view
    float near_m, far_m;          // receivers lie between, along forward; 0 < near < far
    Box receivers;                // what can be seen lies in here
    Box casters;                  // what can throw shadows lies in here
    vec3 to_sun;                  // unit
    uint32_t side_texels;         // of the square map
};

// Where a place p falls in the map: (column, row) = (dot(row_x, (p, 1)), dot(row_y, (p, 1))) / w, depth = dot(row_z, (p, 1)) / w,
// w = dot(row_w, (p, 1)). Receivers have columns and rows in [k_border_texels, side - k_border_texels], depth in [0, 1), 1 nearest
// to the sun, and w >= least_w > 0. Casters nearer to the sun than the range have depths above 1, which may be clamped: nothing seen lies
// there. All finite, whatever the scene.
struct ShadowView {
    vec4 row_x{0.0f}, row_y{0.0f}, row_z{0.0f}, row_w{0.0f, 0.0f, 0.0f, 1.0f};
    float least_w = 0.5f;
};

inline constexpr float k_border_texels = 2.0f;  // for the filter, and for places moved off their surfaces

// kind: not none.
ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene);

}  // namespace coppice
