// A map before it is fitted: rows at right angles to the sun, and from them, tightly around what is seen, texels and depths.
#pragma once
#include <algorithm>
#include <glm/vec4.hpp>
#include "plugins/vegetation/shadow/receiver_hull.h"

namespace coppice {

using glm::dvec4;

// (x, y) / w says where a place falls; to which texels that comes is for fit_rows to say.
struct LightPlaneRows {
    dvec4 x, y, w;
};

inline double at_place(const dvec4& row, dvec3 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w; }

// Two directions across the sun's, unit and at right angles, along as the viewer looks. Where it looks along the sun's rays, any.
struct LightAxes {
    dvec3 across, along;
    double sine;  // of the angle between view and sun
};
LightAxes view_axes(const ShadowScene& scene);

// Requires w > 0 for all of the hull.
ShadowView fit_rows(const LightPlaneRows& rows, const ShadowScene& scene, const ReceiverHull& hull);

LightPlaneRows uniform_rows(const LightAxes& axes);
LightPlaneRows perspective_rows(const ShadowScene& scene, const ReceiverHull& hull);
LightPlaneRows light_space_rows(const ShadowScene& scene, const ReceiverHull& hull);

}  // namespace coppice
