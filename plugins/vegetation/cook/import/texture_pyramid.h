// A base-colour texture as averages: linear colour of its opaque texels only, at every power of two, so that
// nothing of what lies behind the cut-out bleeds into a leaf.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "runtime/core/math.h"
#include "runtime/core/picture.h"

namespace coppice {

// Index of the texel that coordinate i of an axis with `size` texels shows.
int64_t wrap_texel(int64_t i, int64_t size, GltfWrap wrap);

class TexturePyramid {
  public:
    // Texels with alpha (0 to 255) of at least opaque_alpha count; 0: all.
    TexturePyramid(const Picture& picture, GltfWrap wrap_s, GltfWrap wrap_t, uint32_t opaque_alpha);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    // xyz: linear colour times weight; w: opaque share of the texel at uv, level 0 being the texture itself.
    // No filter.
    vec4 texel(vec2 uv, uint32_t level) const;
    uint32_t level_count() const { return uint32_t(levels_.size()) + 1; }
    // Of the opaque texels around uv, from the finest level that has any. Black if the texture has none.
    vec3 nearest_color(vec2 uv) const;

  private:
    struct Level {
        uint32_t width, height;
        std::vector<vec4> texels;
    };
    vec4 base_texel(size_t i) const;

    uint32_t width_, height_;
    GltfWrap wrap_s_, wrap_t_;
    std::vector<uint8_t> base_;  // sRGB and 0 or 255: level 0 is the largest by far
    std::vector<Level> levels_;  // from level 1 on
};

}  // namespace coppice
