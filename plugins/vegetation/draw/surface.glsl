// The 32-bit surface word of plant/surface.h.
#ifndef COPPICE_SURFACE_GLSL
#define COPPICE_SURFACE_GLSL

const uint k_normal_bits = 0xfffu;
const uint k_color_bits = 0x0ffff000u;
const uint k_leaf_bit = 0x80000000u;

// Not normalised: |x| + |y| + |z| = 1.
vec3 decode_normal(uint surface) {
    vec2 q = (vec2(surface & 63u, surface >> 6 & 63u) - 31.5) / 31.5;
    vec3 n = vec3(q.x, 1.0 - abs(q.x) - abs(q.y), q.y);
    vec2 folded = (1.0 - abs(q.yx)) * mix(vec2(1.0), vec2(-1.0), lessThan(q, vec2(0.0)));
    n.xz = n.y < 0.0 ? folded : n.xz;
    return n;
}

// Any length but zero.
uint encode_normal(vec3 n) {
    n /= max(abs(n.x) + abs(n.y) + abs(n.z), 1.0e-30);
    vec2 folded = (1.0 - abs(n.zx)) * mix(vec2(1.0), vec2(-1.0), lessThan(n.xz, vec2(0.0)));
    vec2 q = n.y < 0.0 ? folded : n.xz;
    uvec2 level = uvec2(clamp(floor(q * 31.5 + 32.0), 0.0, 63.0));
    return level.x | level.y << 6;
}

vec3 decode_color_linear(uint surface) {
    vec3 c = vec3(surface >> 12 & 31u, surface >> 17 & 63u, surface >> 23 & 31u) / vec3(31.0, 63.0, 31.0);
    return c * c;
}

// Rounded up or down so that the mean over chances in [0, 1) is the linear mean.
uint encode_color(vec3 color, float chance) {
    vec3 last = vec3(31.0, 63.0, 31.0);
    vec3 scaled = clamp(color, 0.0, 1.0);
    vec3 low = min(floor(sqrt(scaled) * last), last - 1.0);
    vec3 share = (scaled * last * last - low * low) / (2.0 * low + 1.0);
    ivec3 level = ivec3(low) + ivec3(lessThan(vec3(chance), share));
    return uint(level.x << 12 | level.y << 17 | level.z << 23);
}

float decode_openness(uint surface) { return float(surface >> 28 & 7u) / 7.0; }

#endif
