#version 460
// Triangles of one instance and part, three vertices each.
// Triangles that touch many pixels or cross the near plane are put into the list of raster_big_triangles.comp.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"
#include "plugins/vegetation/draw/scan.glsl"

layout(binding = 4) buffer BigTriangles {
    uint big_count;
    uint big_unused[3];
    uvec2 big[];  // first vertex, instance with k_ground_bit
};

const float k_side_limit_px = 32.0;  // longer triangles are shared by a group's lanes

void main() {
    uint index, first_item, step;
    if (!take_entry(index, first_item, step)) return;
    Entry entry = load_entry(index);
    Transform t = load_transform(entry.instance, entry.ground);
    vec2 size = frame.size_px;
    float near_w = frame.near_w;

    for (uint i = first_item; i < entry.count; i += step) {
        uint first_vertex = entry.first_vertex + i * 3u;
        uvec4 v0 = texelFetch(vertices, int(first_vertex));
        uvec4 v1 = texelFetch(vertices, int(first_vertex + 1u));
        uvec4 v2 = texelFetch(vertices, int(first_vertex + 2u));
        vec3 a = project(t, uintBitsToFloat(v0.xyz));
        vec3 b = project(t, uintBitsToFloat(v1.xyz));
        vec3 c = project(t, uintBitsToFloat(v2.xyz));
        vec3 w = vec3(a.z, b.z, c.z);
        if (all(lessThan(w, vec3(near_w)))) continue;
        bool across = any(lessThan(w, vec3(near_w)));
        vec2 low = min(min(a.xy, b.xy), c.xy), high = max(max(a.xy, b.xy), c.xy);
        if (!across) {
            // No pixel centre inside the bounds, or wholly beside the picture.
            if (any(greaterThanEqual(ceil(low - 0.5), min(ceil(high - 0.5), size))) ||
                any(lessThanEqual(high, vec2(0.5))))
                continue;
            // Rows count downwards, so what is wound counter-clockwise for the viewer has a negative area here.
            vec2 to_b = b.xy - a.xy, to_c = c.xy - a.xy;
            if (!k_shadow && entry.cull_back && to_b.x * to_c.y > to_b.y * to_c.x) continue;
        }
        if (across || any(greaterThan(high - low, vec2(k_side_limit_px)))) {
            uint slot = atomicAdd(big_count, 1u);
            if (slot < frame.big_triangle_limit) big[slot] = uvec2(first_vertex, entry.instance | (entry.ground ? k_ground_bit : 0u));
            continue;
        }
        uint surface0 = turn_surface(t, v0.w, k_kind_triangle);
        uint surface1 = turn_surface(t, v1.w, k_kind_triangle);
        uint surface2 = turn_surface(t, v2.w, k_kind_triangle);
        Plane plane = plane_through(a.xy, b.xy, c.xy);
        vec3 depths = vec3(depth_of(t, uintBitsToFloat(v0.xyz), w.x), depth_of(t, uintBitsToFloat(v1.xyz), w.y),
                           depth_of(t, uintBitsToFloat(v2.xyz), w.z));

        Ramp ramp = ramp_through(plane, depths);
        float row_last = min(ceil(high.y - 0.5), size.y);
        for (float row = max(ceil(low.y - 0.5), 0.0); row < row_last; row += 1.0) {
            vec2 span = scan_row(a.xy, b.xy, c.xy, row + 0.5);
            float column_last = min(ceil(span.y - 0.5), size.x);
            for (float column = max(ceil(span.x - 0.5), 0.0); column < column_last; column += 1.0) {
                if (k_shadow) {
                    write_texel(uint(row) * uint(size.x) + uint(column), ramp_at(ramp, vec2(column, row) + 0.5 - a.xy));
                    continue;
                }
                vec3 weight = weights_at(plane, a.xy, vec2(column, row) + 0.5);
                // So small a triangle shows one of its vertices a pixel, each as often as it weighs: interpolation in
                // the mean, for a fraction of its price.
                float chance = dither_chance(ivec2(column, row));
                uint surface = chance < weight.x              ? surface0
                               : chance < weight.x + weight.y ? surface1
                                                              : surface2;
                write_pixel(ivec2(column, row), dot(weight, depths), tint_surface(t, surface, floatBitsToUint(chance)));
            }
        }
    }
}
