#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

ShadowView fit_shadow(ShadowKind kind, const ShadowScene& scene) {
    switch (kind) {
        case ShadowKind::perspective:
            return fit_shadow_perspective(scene);
        case ShadowKind::light_space:
            return fit_shadow_light_space(scene);
        case ShadowKind::none:
        case ShadowKind::clipmap:
        case ShadowKind::uniform:
            break;
    }
    return fit_shadow_uniform(scene);
}

}  // namespace coppice
