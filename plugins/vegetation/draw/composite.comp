#version 460
// Plants over the host's picture, and their depth into its depth. Samples of plants are weighed by the tent of resolve.comp;
// the share of the tent that none covers shows what the host has at the pixel, whose own texture is not blurred so.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/host_picture.glsl"
#include "plugins/vegetation/draw/light.glsl"

layout(constant_id = 1) const uint k_color_kind = 0;  // bytes with red lowest, with blue lowest, four halves
layout(binding = 0) readonly buffer Visibility { uint64_t visibility[]; };
layout(binding = 1) readonly buffer Words { uint words[]; };
layout(binding = 2) writeonly buffer Depth { float depth[]; };
layout(binding = 3) readonly buffer Lights { Light light; };
layout(binding = 4) readonly buffer Radiance { float radiance[]; };  // three a pixel
layout(binding = 5) buffer Color { uint color[]; };

const uint k_view_coverage = 2u;

bool covers(uint i) { return visibility[i] != uint64_t(words[i]) << 32; }

vec3 decode_srgb(vec3 c) {
    return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

// sum: of plants' light, each times its weight; share: sum of the weights, in (0, 1].
void show(uint i, vec3 sum, float share) {
    if (k_color_kind == 2u) {
        uint place = 2u * i;
        vec2 red_green = unpackHalf2x16(color[place]), blue_alpha = unpackHalf2x16(color[place + 1u]);
        vec3 shown = mix(vec3(red_green, blue_alpha.x), sum * light.to_sun.w / share, share);
        color[place] = packHalf2x16(min(shown.rg, 65504.0));
        color[place + 1u] = packHalf2x16(vec2(min(shown.b, 65504.0), mix(blue_alpha.y, 1.0, share)));
        return;
    }
    vec3 shown = frame.view == k_view_coverage ? encode_srgb(sum / share) : present(light, sum / share);
    uint word = color[i];
    if (share < 0.999) {
        uvec3 bytes = uvec3(word, word >> 8, word >> 16) & 255u;
        vec3 behind = vec3(k_color_kind == 0u ? bytes.rgb : bytes.bgr) / 255.0;
        shown = encode_srgb(mix(decode_srgb(behind), decode_srgb(shown), share));
    }
    uvec3 bytes = uvec3(shown * 255.0 + 0.5);
    bytes = k_color_kind == 0u ? bytes : bytes.bgr;
    color[i] = bytes.x | bytes.y << 8 | bytes.z << 16 | 0xff000000u;
}

void main() {
    uint row, first, last;
    if (!take_run(row, first, last)) return;
    float side = frame.side_weight, own = 1.0 / (1.0 + 2.0 * side);
    for (uint column = first + gl_LocalInvocationID.x; column < last; column += gl_WorkGroupSize.x) {
        vec3 sum = vec3(0.0);
        float share = 0.0;
        for (int down = -1; down <= 1; ++down)
            for (int right = -1; right <= 1; ++right) {
                uint at_row = uint(clamp(int(row) + down, 0, int(frame.height) - 1));
                uint at_column = uint(clamp(int(column) + right, 0, int(frame.width) - 1));
                uint i = at_row * frame.width + at_column;
                if (!covers(i)) continue;
                float weight = own * own * (down == 0 ? 1.0 : side) * (right == 0 ? 1.0 : side);
                sum += weight * vec3(radiance[3u * i], radiance[3u * i + 1u], radiance[3u * i + 2u]);
                share += weight;
            }
        uint i = row * frame.width + column;
        if (share > 0.0) show(i, sum, min(share, 1.0));
        if (covers(i))
            depth[i] = frame.depth_offset + frame.depth_scale * uintBitsToFloat(uint(visibility[i] >> 32)) / frame.near_m;
    }
}
