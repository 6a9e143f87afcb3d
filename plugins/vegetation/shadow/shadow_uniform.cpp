// An orthographic map: every receiver gets texels of one size.
#include "plugins/vegetation/shadow/fit_plane_map.h"
#include "plugins/vegetation/shadow/receiver_hull.h"

namespace coppice {

ShadowView fit_shadow_uniform(const ShadowScene& scene) {
    const CheckedShadowScene checked = check_shadow_scene(scene);
    return fit_plane_map(checked, ReceiverHull(checked), glm::dvec2(0.0), 0.0);
}

}  // namespace coppice
