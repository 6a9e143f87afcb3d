#include "plugins/vegetation/cook/import/average_colors.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr uint32_t k_most_steps = 16;  // a side of the grid of samples in a triangle

}  // namespace

std::vector<vec3> average_colors(const TexturePyramid& texture, std::span<const vec2> uvs,
                                 std::span<const uint32_t> indices) {
    std::vector<vec4> sums(uvs.size(), vec4(0.0f));
    vec2 texels(float(texture.width()), float(texture.height()));
    for (size_t t = 0; t + 2 < indices.size(); t += 3) {
        vec2 corner[3];
        for (size_t c = 0; c < 3; ++c) corner[c] = uvs[indices[t + c]];
        float longest = 0.0f;
        for (size_t c = 0; c < 3; ++c) {
            vec2 edge = glm::abs((corner[(c + 1) % 3] - corner[c]) * texels);
            longest = std::max({longest, edge.x, edge.y});
        }
        // As many samples as there are texels, up to a limit; beyond it, samples of a coarser level.
        uint32_t level = 0, n = k_most_steps;
        while (longest > 1.5f * float(k_most_steps) && level + 1 < texture.level_count()) {
            longest *= 0.5f;
            ++level;
        }
        if (longest < float(n)) n = std::max(1u, uint32_t(longest) + 1u);
        vec2 a = corner[1] - corner[0], b = corner[2] - corner[0];
        float area = std::fabs(a.x * b.y - a.y * b.x) / float(n * n) + 1.0e-20f;
        float step = 1.0f / (3.0f * float(n));
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; i + j < n; ++j)
                for (uint32_t half = 0; half < 2 && i + j + half < n;
                     ++half) {  // the two kinds of small triangles
                    float s = float(3 * i + 1 + half) * step, r = float(3 * j + 1 + half) * step;
                    vec4 sample = texture.texel(corner[0] + a * s + b * r, level) * area;
                    sums[indices[t]] += sample * (1.0f - s - r);
                    sums[indices[t + 1]] += sample * s;
                    sums[indices[t + 2]] += sample * r;
                }
    }
    std::vector<vec3> colors(uvs.size());
    for (size_t v = 0; v < uvs.size(); ++v)
        colors[v] = sums[v].w > 0.0f ? vec3(sums[v]) * (1.0f / sums[v].w) : texture.nearest_color(uvs[v]);
    return colors;
}

}  // namespace coppice
