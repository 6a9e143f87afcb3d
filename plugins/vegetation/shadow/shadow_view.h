// Where a map of the sun's shadows looks from. All coordinates are relative to the viewer, axes are the world's, m.
//
// The sun is a point at infinity, so whatever lies behind each other towards it falls on one place of the map: columns,
// rows and w depend on the plane at right angles to the sun alone. Every map of a sun, perspective maps included, is
// therefore a homography of that plane, and the kinds differ in one thing only: how w grows over the plane, which is
// how much larger near things are drawn. A caster has the w of the receivers that it shadows, also when it stands
// behind the viewer, and nothing that throws a shadow on them is ever clipped.
#pragma once
#include "plugins/vegetation/lod/settings.h"
#include "runtime/core/math.h"

namespace coppice {

// What a map is to show.
struct ShadowScene {
    vec3 right, up, forward;     // the camera's axes, unit
    float tangent_x, tangent_y;  // of half its angles of view
    float near_m, far_m;         // receivers lie between, along forward; 0 < near < far
    Box receivers;               // what can be seen lies in here; cut by the frustum inside
    Box casters;                 // what can throw shadows lies in here
    vec3 to_sun;                 // unit
    uint32_t side_texels;        // of the square map, at least 16
};

// Place p falls on (column, row) = (dot(row_x, (p, 1)), dot(row_y, (p, 1))) / w, depth = dot(row_z, (p, 1)) / w, with
// w = dot(row_w, (p, 1)). Columns and rows in texels, [0, side_texels]. Depth grows towards the sun along every ray, by
// dot(row_z, (to_sun, 0)) / w a metre; in [0, 1/2] from the lowest receiver up to the highest caster, what lies lower has
// less than 0: clamp it. Receivers have w >= 2 least_w and fall k_shadow_border_texels or more inside the map. What has
// w < least_w shadows none of them and may be cut off.
struct ShadowView {
    vec4 row_x, row_y, row_z, row_w;
    float least_w;
};

inline constexpr float k_shadow_border_texels = 2.0f;  // room for the filter

// Pure functions; the same bytes from every compiler. Whatever the scene holds (no receivers, far before near, what is
// not finite), all they return is finite.
ShadowView fit_shadow_uniform(const ShadowScene& scene);  // orthographic; w = 1
// Stamminger and Drettakis 2002, ERRATA 6: a map of the viewer's post-perspective space.
ShadowView fit_shadow_perspective(const ShadowScene& scene);
// Wimmer et al. 2004, ERRATA 6: w grows along the view in the light's plane; becomes the uniform map over a band of
// angles between light and view.
ShadowView fit_shadow_light_space(const ShadowScene& scene);
ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene);  // none and nested ones: as uniform

}  // namespace coppice
