#version 460
// Leaves of one instance and part, at a level of detail of its crown: quads of two triangles, (0, 1, 2) and (0, 2, 3), that
// may be bent but are lit by one normal. Of the run of leaves that is looked at those are drawn that are born by the
// entry's level (plant/leaf_bands.h).
// A leaf that reaches behind the near plane is left out, as a point there is: leaves are a few d' large.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"

vec3 steps_of(uint xy, uint z) { return vec3(xy & 0xffffu, xy >> 16, z & 0xffffu); }

// Of a triangle with its first corner at a, over places from there: what the other two weigh, and the depth.
struct Half {
    vec2 to_b, to_c, slope;
    float none;  // < 0: no area
};

Half half_of(vec2 b, vec2 c, float depth_b, float depth_c) {
    float area = b.x * c.y - b.y * c.x;
    float inverse = area != 0.0 ? 1.0 / area : 0.0;
    vec2 to_b = vec2(c.y, -c.x) * inverse, to_c = vec2(-b.y, b.x) * inverse;
    return Half(to_b, to_c, to_b * depth_b + to_c * depth_c, area != 0.0 ? 0.0 : -1.0);
}

// 0 outside.
float depth_at(Half part, vec2 from_a, float depth_a) {
    float b = dot(part.to_b, from_a) + part.none, c = dot(part.to_c, from_a);
    return min(b, c) >= 0.0 && b + c <= 1.0 ? depth_a + dot(part.slope, from_a) : 0.0;
}

void main() {
    uint index, first_item, step;
    if (!take_entry(index, first_item, step)) return;
    Entry entry = load_entry(index);
    Transform t = load_transform(entry.instance, false);
    vec2 size = frame.size_px;
    float near_w = frame.near_w;
    // From steps of the grid in place of metres.
    vec3 origin = uintBitsToFloat(texelFetch(vertices, int(entry.grid)).xyz);
    vec3 step_m = uintBitsToFloat(texelFetch(vertices, int(entry.grid + 1u)).xyz);
    Transform from_grid = t;
    from_grid.to_x = vec4(t.to_x.xyz * step_m, dot(t.to_x, vec4(origin, 1.0)));
    from_grid.to_y = vec4(t.to_y.xyz * step_m, dot(t.to_y, vec4(origin, 1.0)));
    from_grid.to_w = vec4(t.to_w.xyz * step_m, dot(t.to_w, vec4(origin, 1.0)));
    from_grid.to_z = vec4(t.to_z.xyz * step_m, dot(t.to_z, vec4(origin, 1.0)));

    for (uint i = first_item; i < entry.count; i += step) {
        uvec4 end = texelFetch(vertices, int(entry.first_vertex + i * 2u + 1u));
        if (end.w > entry.owner_min) continue;
        uvec4 begin = texelFetch(vertices, int(entry.first_vertex + i * 2u));
        vec3 corner_a = steps_of(begin.x, begin.y), corner_c = steps_of(begin.w, end.x);
        vec3 corner_b = steps_of(begin.y >> 16 | begin.z << 16, begin.z >> 16);
        vec3 corner_d = steps_of(end.x >> 16 | end.y << 16, end.y >> 16);
        vec3 a = project(from_grid, corner_a), b = project(from_grid, corner_b);
        vec3 c = project(from_grid, corner_c), d = project(from_grid, corner_d);
        vec4 w = vec4(a.z, b.z, c.z, d.z);
        vec2 low = min(min(a.xy, b.xy), min(c.xy, d.xy)), high = max(max(a.xy, b.xy), max(c.xy, d.xy));
        if (!all(greaterThanEqual(w, vec4(near_w))) ||
            any(greaterThanEqual(ceil(low - 0.5), min(ceil(high - 0.5), size))) || any(lessThanEqual(high, vec2(0.5))))
            continue;
        vec4 depths = vec4(depth_of(from_grid, corner_a, w.x), depth_of(from_grid, corner_b, w.y),
                           depth_of(from_grid, corner_c, w.z), depth_of(from_grid, corner_d, w.w));
        uint surface = tint_surface(t, turn_surface(t, end.z, k_kind_leaf), begin.x ^ begin.y);
        Half first = half_of(b.xy - a.xy, c.xy - a.xy, depths.y - depths.x, depths.z - depths.x);
        Half second = half_of(c.xy - a.xy, d.xy - a.xy, depths.z - depths.x, depths.w - depths.x);

        // Leaves have few pixels and no neighbours to fit, so each pixel of the box around one is asked.
        vec2 from = max(ceil(low - 0.5), vec2(0.0)), last = min(ceil(high - 0.5), size);
        vec2 pixel = from;
        while (pixel.y < last.y) {
            vec2 from_a = pixel + 0.5 - a.xy;
            // Where both triangles of a fold are seen, the nearer one.
            float depth = max(depth_at(first, from_a, depths.x), depth_at(second, from_a, depths.x));
            if (depth > 0.0) {
                if (k_shadow)
                    write_texel(uint(pixel.y) * uint(size.x) + uint(pixel.x), depth);
                else
                    write_pixel(ivec2(pixel), depth, surface);
            }
            pixel.x += 1.0;
            pixel = pixel.x < last.x ? pixel : vec2(from.x, pixel.y + 1.0);
        }
    }
}
