// Is a surface closed, so that only its front half can be seen? Bark tubes open at the end should count as
// closed.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

inline constexpr float k_closed_share = 0.9f;  // from here on a part counts as closed

// Share of the welded edges' length that lies between exactly two triangles of the same orientation. 0 for no
// triangle.
float closed_share(const PartDescription& part, const std::vector<uint32_t>& welded);

}  // namespace coppice
