#include "plugins/vegetation/plant/surface.h"

#include <algorithm>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

// The level q in [0, last] whose square-root coding has the linear mean `linear` under the uniform `chance`.
uint32_t dither_level(float linear, uint32_t last, float chance) {
    linear = std::clamp(linear == linear ? linear : 0.0f, 0.0f, 1.0f);
    uint32_t low = std::min(uint32_t(std::sqrt(linear) * float(last)), last - 1);
    auto value = [last](uint32_t q) { return float(q) * float(q) / (float(last) * float(last)); };
    float share = (linear - value(low)) / (value(low + 1) - value(low));
    return chance < share ? low + 1 : low;
}

uint32_t octahedral_level(float v) {
    return uint32_t(std::clamp(std::floor(v * 31.5f + 32.0f), 0.0f, 63.0f));
}
float octahedral_value(uint32_t q) { return (float(q) - 31.5f) / 31.5f; }

}  // namespace

uint32_t encode_surface(const Surface& surface, uint32_t dither) {
    vec3 n = normalize_or(surface.normal, vec3(0, 1, 0));
    n = n * (1.0f / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z)));
    float u = n.x, v = n.z;
    if (n.y < 0.0f) {
        u = (1.0f - std::fabs(n.z)) * (n.x < 0.0f ? -1.0f : 1.0f);
        v = (1.0f - std::fabs(n.x)) * (n.z < 0.0f ? -1.0f : 1.0f);
    }
    auto chance = [&dither] {
        dither = mix_bits(dither + 0x9e3779b9u);
        return float(dither >> 8) * 0x1p-24f;
    };
    uint32_t bits = octahedral_level(u) | octahedral_level(v) << 6;
    bits |= dither_level(surface.color_linear.x, 31, chance()) << 12;
    bits |= dither_level(surface.color_linear.y, 63, chance()) << 17;
    bits |= dither_level(surface.color_linear.z, 31, chance()) << 23;
    float open = std::clamp(surface.openness == surface.openness ? surface.openness : 1.0f, 0.0f, 1.0f);
    bits |= std::min(7u, uint32_t(open * 7.0f + chance())) << 28;
    return bits | (surface.leaf ? k_leaf_bit : 0u);
}

uint32_t replace_normal(uint32_t surface_bits, vec3 normal) {
    constexpr uint32_t k_normal_bits = 0xfffu;
    return (surface_bits & ~k_normal_bits) |
           (encode_surface({normal, vec3(0.0f), 0.0f, false}, 0) & k_normal_bits);
}

Surface decode_surface(uint32_t bits) {
    Surface surface;
    float u = octahedral_value(bits & 63u), v = octahedral_value(bits >> 6 & 63u);
    vec3 n(u, 1.0f - std::fabs(u) - std::fabs(v), v);
    if (n.y < 0.0f) {
        n.x = (1.0f - std::fabs(v)) * (u < 0.0f ? -1.0f : 1.0f);
        n.z = (1.0f - std::fabs(u)) * (v < 0.0f ? -1.0f : 1.0f);
    }
    surface.normal = normalize_or(n, vec3(0, 1, 0));
    float r = float(bits >> 12 & 31u) / 31.0f, g = float(bits >> 17 & 63u) / 63.0f,
          b = float(bits >> 23 & 31u) / 31.0f;
    surface.color_linear = vec3(r * r, g * g, b * b);
    surface.openness = float(bits >> 28 & 7u) / 7.0f;
    surface.leaf = (bits & k_leaf_bit) != 0;
    return surface;
}

}  // namespace coppice
