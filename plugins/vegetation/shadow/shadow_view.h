// Where a shadow map looks from.
#pragma once
#include "plugins/vegetation/lod/settings.h"
#include "runtime/core/math.h"

namespace coppice {

// What a map is to show. All relative to the viewer, m.
struct ShadowScene {
    vec3 right, up, forward;         // the camera's axes, unit
    float tangent_x, tangent_y;      // of half its angles of view
    float near_m, far_m;             // receivers lie between, along forward; 0 < near < far
    Box receivers;                   // what can be seen lies in here
    Box casters;                     // what can throw shadows lies in here
    vec3 to_sun;                     // unit
    uint32_t side_texels;            // of the square map
};

// Where a place p falls in the map: (column, row) = (dot(row_x, (p, 1)), dot(row_y, (p, 1))) / w, depth = dot(row_z, (p, 1)) / w,
// w = dot(row_w, (p, 1)). Columns and rows in texels, [0, side_texels]; depth in [0, 1], 1 nearest to the sun; w >= least_w > 0
// for all that is kept.
struct ShadowView {
    vec4 row_x{0.0f}, row_y{0.0f}, row_z{0.0f}, row_w{0.0f, 0.0f, 0.0f, 1.0f};
    float least_w = 0.5f;
};

ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene);

}  // namespace coppice
