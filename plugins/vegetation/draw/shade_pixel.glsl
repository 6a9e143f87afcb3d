// What resolve and accumulate share: the frame's constants, and the light of one pixel from its depth and surface word.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "plugins/vegetation/draw/surface.glsl"
#include "plugins/vegetation/draw/light.glsl"
#include "plugins/vegetation/draw/sunlit.glsl"

layout(local_size_x_id = 0) in;

layout(push_constant) uniform Frame {
    vec4 right;         // camera axis over the focal length in pixels; w: image width
    vec4 up;            // likewise; w: image height
    vec4 forward;       // w: near distance in m
    vec2 shift_px;      // where in the pixel the frame is sampled, from its centre
    uint view;          // RepresentationView of lod/settings.h
    float new_share;    // accumulate: of this frame in the mean; 1: those before are forgotten
    float side_weight;  // resolve: of a neighbour beside or above, over the pixel's own
} frame;

layout(binding = 0) readonly buffer Visibility { uint64_t visibility[]; };
layout(binding = 2) buffer Radiance { float radiance[]; };  // three a pixel: the mean of a view at rest

const uint k_view_kinds = 1u, k_view_coverage = 2u;

vec3 shade_pixel(Light sun, uint column, uint row) {
    uint64_t word = visibility[row * uint(frame.right.w) + column];
    uint surface = uint(word);
    float depth = uintBitsToFloat(uint(word >> 32));
    vec2 place = vec2(column, row) + 0.5 + frame.shift_px - 0.5 * vec2(frame.right.w, frame.up.w);
    vec3 ray = frame.forward.xyz + frame.right.xyz * place.x - frame.up.xyz * place.y;
    float ray_length = length(ray);
    vec3 direction = ray / ray_length;
    bool covered = depth > 0.0;
    float distance_m = frame.forward.w / max(depth, 1.0e-12) * ray_length;
    vec3 normal = decode_normal(surface);
    normal *= inversesqrt(max(dot(normal, normal), 1.0e-12));
    vec3 albedo = decode_color_linear(surface);
    float openness = decode_openness(surface);
    float sunlit = stand_in_sun(openness);
    if (k_shadow_maps > 0u && covered)
        sunlit = sunlit_share(sun, direction * distance_m, distance_m, distance_m / ray_length, normal, sunlit);
    vec3 lit = shade(sun, normal, -direction, albedo, openness, sunlit, (surface & k_leaf_bit) != 0u);
    vec3 shown = covered ? apply_haze(sun, lit, direction, distance_m) : sky_radiance(sun, direction);
    if (frame.view == k_view_kinds) shown = covered ? albedo * (0.3 + 0.7 * abs(normal.y)) : shown;
    if (frame.view == k_view_coverage) shown = covered ? albedo : vec3(0.0);
    return shown;
}
