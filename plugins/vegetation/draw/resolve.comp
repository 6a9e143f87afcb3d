#version 460
// Lights each pixel once, from its depth and surface word. One group takes a run of 256 pixels, a lane every n-th.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "plugins/vegetation/draw/surface.glsl"
#include "plugins/vegetation/draw/light.glsl"

layout(local_size_x_id = 0) in;

layout(push_constant) uniform Frame {
    vec4 right;    // camera axis over the focal length in pixels; w: image width
    vec4 up;       // likewise; w: image height
    vec4 forward;  // w: near distance in m
    uint show_kinds;
} frame;

layout(binding = 0) readonly buffer Visibility { uvec2 visibility[]; };
layout(binding = 1) writeonly buffer Color { uint color[]; };
layout(binding = 2) readonly buffer Lights { Light light; };

const uint k_run = 256u;

void main() {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    uint width = uint(frame.right.w), total = width * uint(frame.up.w);
    Light sun = light;
    for (uint i = gl_LocalInvocationID.x; i < k_run; i += gl_WorkGroupSize.x) {
        uint index = group * k_run + i;
        if (index >= total) break;
        uvec2 word = visibility[index];
        vec2 pixel = vec2(float(index % width), float(index / width)) + 0.5;
        vec3 ray = frame.forward.xyz + frame.right.xyz * (pixel.x - 0.5 * frame.right.w) -
                   frame.up.xyz * (pixel.y - 0.5 * frame.up.w);
        float ray_length = length(ray);
        vec3 direction = ray / ray_length;
        float depth = uintBitsToFloat(word.y);
        bool covered = depth > 0.0;
        float distance_m = frame.forward.w / max(depth, 1.0e-12) * ray_length;
        vec3 normal = decode_normal(word.x);
        normal /= max(length(normal), 1.0e-6);
        vec3 albedo = decode_color_linear(word.x);
        vec3 lit = shade(sun, normal, -direction, albedo, decode_openness(word.x), (word.x & k_leaf_bit) != 0u);
        lit = apply_haze(sun, lit, direction, distance_m);
        vec3 shown = covered ? lit : sky_radiance(sun, direction);
        shown = frame.show_kinds != 0u && covered ? albedo * (0.3 + 0.7 * abs(normal.y)) : shown;
        uvec3 bytes = uvec3(present(sun, shown) * 255.0 + 0.5);
        color[index] = bytes.x | bytes.y << 8 | bytes.z << 16 | 0xff000000u;
    }
}
