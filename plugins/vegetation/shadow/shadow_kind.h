// Which shadow map a frame draws; what each does: docs/shadows.md.
#pragma once
#include <cstdint>

namespace coppice {

enum class ShadowKind : uint8_t { none, uniform, perspective, light_space };

}  // namespace coppice
