// What can throw a shadow into the picture: all that lies between what is seen and the sun. The convex hull of the view,
// cut at far_m, and its shift towards the sun without end: of the view's faces those that look away from the sun, and
// planes along the sun's rays through the edges between those and the others.
#pragma once
#include "plugins/vegetation/cull/frustum.h"

namespace coppice {

// The view's axes and focal length stay, so that casters outside of the picture are looked at from the viewer as well. The near
// distance bounds nothing. Requires a picture's frustum, unit to_sun, far_m > 0.
Frustum make_caster_frustum(const Frustum& view, vec3 to_sun, float far_m);

}  // namespace coppice
