// Alpha-masked cards to geometry: the outline of what is opaque is traced in the texture, simplified without
// changing its area, triangulated, coloured, and laid onto each triangle that shows the texture. Cards that
// show the same piece of a texture share one cut. Area of a cut: the opaque share of the card, within a
// texel's rounding of the outline. Coverage is what counts from afar, so the simplification keeps areas
// exactly (simplify_outline.h).
#pragma once
#include <cstdint>
#include "plugins/vegetation/cook/import/import_mesh.h"
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "runtime/core/picture.h"

namespace coppice {

struct AlphaCutSettings {
    // Area that the simplified outline may put on the wrong side of the true one, as a share of the opaque
    // area. 0.04 makes about 9 triangles of an oval leaf.
    float displaced_share = 0.04f;
    // Triangles that all cards of the plant may become together; beyond it, outlines become rougher than
    // displaced_share asks for, but no card gets fewer than a few.
    uint32_t triangle_target = 250'000;
    // Sides of the grid the outline is traced on; larger textures are averaged down.
    uint32_t grid_side_limit = 2048;
};

// mesh: with uvs and elements. Returns what is opaque of it, coloured, without uvs. Triangles whose texture
// repeats more than a few times are left whole. opaque_alpha: in (0, 255], texels of at least this alpha are
// opaque. settings: triangle_target is this mesh's share.
ImportMesh cut_alpha(const ImportMesh& mesh, const Picture& picture, GltfWrap wrap_s, GltfWrap wrap_t,
                     float opaque_alpha, const AlphaCutSettings& settings);

}  // namespace coppice
