#include "plugins/vegetation/cook/import/texture_pyramid.h"

#include <algorithm>
#include <array>

namespace coppice {
namespace {

const std::array<float, 256>& linear_of_srgb() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values;
        for (size_t i = 0; i < values.size(); ++i) values[i] = srgb_to_linear(float(i) / 255.0f);
        return values;
    }();
    return table;
}

}  // namespace

int64_t wrap_texel(int64_t i, int64_t size, GltfWrap wrap) {
    if (wrap == GltfWrap::clamp) return std::clamp<int64_t>(i, 0, size - 1);
    int64_t period = wrap == GltfWrap::mirror ? 2 * size : size;
    i %= period;
    if (i < 0) i += period;
    return i < size ? i : period - 1 - i;
}

TexturePyramid::TexturePyramid(const Picture& picture, GltfWrap wrap_s, GltfWrap wrap_t,
                               uint32_t opaque_alpha)
    : width_(picture.width), height_(picture.height), wrap_s_(wrap_s), wrap_t_(wrap_t), base_(picture.rgba) {
    for (size_t i = 3; i < base_.size(); i += 4) base_[i] = base_[i] >= opaque_alpha ? 255 : 0;
    for (uint32_t w = width_, h = height_; w > 1 || h > 1;) {
        Level level{(w + 1) / 2, (h + 1) / 2, {}};
        level.texels.resize(size_t(level.width) * level.height);
        const Level* finer = levels_.empty() ? nullptr : &levels_.back();
        auto fetch = [&](uint32_t x, uint32_t y) {
            if (x >= w || y >= h) return vec4(0.0f);
            size_t i = size_t(y) * w + x;
            return finer ? finer->texels[i] : base_texel(i);
        };
        for (uint32_t y = 0; y < level.height; ++y)
            for (uint32_t x = 0; x < level.width; ++x)
                level.texels[size_t(y) * level.width + x] =
                    (fetch(2 * x, 2 * y) + fetch(2 * x + 1, 2 * y) + fetch(2 * x, 2 * y + 1) +
                     fetch(2 * x + 1, 2 * y + 1)) *
                    0.25f;
        w = level.width;
        h = level.height;
        levels_.push_back(std::move(level));
    }
}

vec4 TexturePyramid::base_texel(size_t i) const {
    const auto& table = linear_of_srgb();
    const uint8_t* p = &base_[i * 4];
    return p[3] ? vec4(table[p[0]], table[p[1]], table[p[2]], 1.0f) : vec4(0.0f);
}

vec4 TexturePyramid::texel(vec2 uv, uint32_t level) const {
    int64_t x = wrap_texel(int64_t(std::floor(double(uv.x) * width_)), width_, wrap_s_);
    int64_t y = wrap_texel(int64_t(std::floor(double(uv.y) * height_)), height_, wrap_t_);
    if (level == 0 || levels_.empty()) return base_texel(size_t(y) * width_ + size_t(x));
    level = std::min(level, uint32_t(levels_.size()));
    const Level& at = levels_[level - 1];
    return at.texels[size_t(y >> level) * at.width + size_t(x >> level)];
}

vec3 TexturePyramid::nearest_color(vec2 uv) const {
    for (uint32_t level = 0; level < level_count(); ++level) {
        vec4 sum = texel(uv, level);
        if (sum.w > 0.0f) return vec3(sum) * (1.0f / sum.w);
    }
    return vec3(0.0f);
}

}  // namespace coppice
