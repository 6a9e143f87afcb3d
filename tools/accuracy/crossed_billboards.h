// Three pictures of a plant on planes that cross in its middle, at right angles: how plants in the distance were long
// drawn, and what points are to be compared with.
// The rasteriser knows no textures, so a texel that is opaque is a point, as large as the texel. Seen at an angle the
// points face the viewer, where a texture's texels would narrow.
#pragma once
#include "tools/accuracy/substitute_models.h"

namespace coppice {

inline constexpr uint32_t k_billboard_texels = 128;  // of the finest texture along the plant's largest extent
inline constexpr uint32_t k_billboard_octaves = 5;   // halvings down to the coarsest, of 4 texels
// Textures from one halving of the resolution to the next: a texel is drawn as large as a sample, to 4 %.
inline constexpr uint32_t k_billboard_steps = 8;

// The full geometry, then the textures from the finest to the coarsest, as long as a texel is opaque. A texel is the
// mean of what it holds, or clear; which of them are opaque is chosen such that the covered area stays. To be drawn
// with the default settings, d' at least the texel's size on the picture and at most a step more: then all points are
// drawn (99 % at the least), and of the coarsest texture, which has to do for any distance, p = n (texel / d')^2.
// Same plant, same bytes. Errors: load_plant_from_memory's.
Result<SubstituteLadder> make_crossed_billboards_ladder(const Plant& plant);

}  // namespace coppice
