// What receives shadows in the picture: the view frustum, cut by the box of receivers, as the corners of a convex body.
#pragma once
#include <vector>
#include "plugins/vegetation/shadow/shadow_scene.h"

namespace coppice {

// At most 48 corners, some twice. Never empty: where nothing can be seen, the middle of the near plane.
std::vector<dvec3> receiver_hull(const CheckedShadowScene& scene);

}  // namespace coppice
