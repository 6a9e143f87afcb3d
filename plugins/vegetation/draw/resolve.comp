#version 460
// Lights each pixel once, from its depth and surface word. One group takes up to 256 pixels of a row, a lane every
// n-th. With k_keep the mean over the frames of a view at rest is kept, and shown.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "plugins/vegetation/draw/surface.glsl"
#include "plugins/vegetation/draw/light.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const bool k_keep = false;

layout(push_constant) uniform Frame {
    vec4 right;    // camera axis over the focal length in pixels; w: image width
    vec4 up;       // likewise; w: image height
    vec4 forward;  // w: near distance in m
    uint view;         // RepresentationView of lod/settings.h
    float new_share;   // of this frame in the mean; 1: those before are forgotten
    vec2 shift_px;     // where in the pixel the frame is sampled, from its centre
} frame;

layout(binding = 0) readonly buffer Visibility { uint64_t visibility[]; };
layout(binding = 1) writeonly buffer Color { uint color[]; };
layout(binding = 2) readonly buffer Lights { Light light; };
layout(binding = 3) buffer Radiance { float radiance[]; };  // three a pixel; of k_keep alone

const uint k_run = 256u;  // pixels of one row

void main() {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    uint width = uint(frame.right.w), runs_a_row = (width + k_run - 1u) / k_run;
    uint row = group / runs_a_row, first = (group - row * runs_a_row) * k_run;
    if (row >= uint(frame.up.w)) return;
    uint last = min(first + k_run, width);
    Light sun = light;
    vec3 ray_row = frame.forward.xyz - frame.right.xyz * (0.5 * frame.right.w - 0.5 - frame.shift_px.x) -
                   frame.up.xyz * (float(row) + 0.5 + frame.shift_px.y - 0.5 * frame.up.w);
    for (uint column = first + gl_LocalInvocationID.x; column < last; column += gl_WorkGroupSize.x) {
        uint index = row * width + column;
        uint64_t word = visibility[index];
        uint surface = uint(word);
        float depth = uintBitsToFloat(uint(word >> 32));
        vec3 ray = ray_row + frame.right.xyz * float(column);
        float ray_length = length(ray);
        vec3 direction = ray / ray_length;
        bool covered = depth > 0.0;
        float distance_m = frame.forward.w / max(depth, 1.0e-12) * ray_length;
        vec3 normal = decode_normal(surface);
        normal *= inversesqrt(max(dot(normal, normal), 1.0e-12));
        vec3 albedo = decode_color_linear(surface);
        vec3 lit = shade(sun, normal, -direction, albedo, decode_openness(surface), (surface & k_leaf_bit) != 0u);
        lit = apply_haze(sun, lit, direction, distance_m);
        vec3 shown = covered ? lit : sky_radiance(sun, direction);
        shown = frame.view == 1u && covered ? albedo * (0.3 + 0.7 * abs(normal.y)) : shown;
        shown = frame.view == 2u ? (covered ? albedo : vec3(0.0)) : shown;
        if (k_keep) {
            uint place = index * 3u;
            if (frame.new_share < 1.0)
                shown = mix(vec3(radiance[place], radiance[place + 1u], radiance[place + 2u]), shown, frame.new_share);
            radiance[place] = shown.r;
            radiance[place + 1u] = shown.g;
            radiance[place + 2u] = shown.b;
        }
        uvec3 bytes = uvec3(present(sun, shown) * 255.0 + 0.5);
        color[index] = bytes.x | bytes.y << 8 | bytes.z << 16 | 0xff000000u;
    }
}
