#version 460
// Triangles from the list that raster_triangles.comp wrote: those that touch many pixels or cross the near plane.
// The lanes of a group share one triangle: rows one after another, its pixels side by side. What lies before the near
// plane is cut away, which leaves a triangle or two.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"
#include "plugins/vegetation/draw/scan.glsl"

layout(binding = 4) readonly buffer BigTriangles {
    uint big_count;
    uint big_unused[3];
    uvec2 big[];
};

struct Corner {
    vec3 place;     // column * w, row * w, w
    float depth_w;  // of the shadow map: depth * w
    vec3 normal;    // world space, any length
    vec3 color;     // linear
    float openness;
};

Corner load_corner(Transform t, uint index, out uint surface) {
    uvec4 v = texelFetch(vertices, int(index));
    surface = turn_surface(t, v.w, k_kind_triangle);
    vec3 normal = decode_normal(surface);
    vec4 p = vec4(uintBitsToFloat(v.xyz), 1.0);
    return Corner(vec3(dot(t.to_x, p), dot(t.to_y, p), dot(t.to_w, p)), dot(t.to_z, p), normal / max(length(normal), 1.0e-6),
                  k_tinted ? tint_color(t, decode_color_linear(surface)) : decode_color_linear(surface), decode_openness(surface));
}

// Where an edge crosses the near plane; always from the corner behind it, so that both triangles of the edge agree.
Corner cut_edge(Corner behind, Corner ahead) {
    float near_w = frame.near_w;
    float s = clamp((near_w - behind.place.z) / (ahead.place.z - behind.place.z), 0.0, 1.0);
    return Corner(vec3(mix(behind.place.xy, ahead.place.xy, s), near_w), mix(behind.depth_w, ahead.depth_w, s), mix(behind.normal, ahead.normal, s),
                  mix(behind.color, ahead.color, s), mix(behind.openness, ahead.openness, s));
}

// Rounded up or down by a fixed pattern, so that slow gradients show no bands.
uint pack_surface(vec3 normal, vec3 color, float openness, uint leaf, ivec2 pixel) {
    float chance = dither_chance(pixel);
    uint open = uint(min(openness * 7.0 + chance, 7.0));
    return encode_normal(normal) | encode_color(color, chance) | open << 28 | leaf;
}

void draw_triangle(Corner corners[3], uint leaf) {
    vec2 size = frame.size_px;
    float near_w = frame.near_w;
    vec3 inverse_w = 1.0 / max(vec3(corners[0].place.z, corners[1].place.z, corners[2].place.z), vec3(near_w));
    // Divided as project() does, so that edges shared with small triangles fall on the same places.
    vec2 a = corners[0].place.xy / corners[0].place.z, b = corners[1].place.xy / corners[1].place.z,
         c = corners[2].place.xy / corners[2].place.z;
    Plane plane = plane_through(a, b, c);
    Ramp ramp = ramp_through(plane, vec3(corners[0].depth_w, corners[1].depth_w, corners[2].depth_w) * inverse_w);
    float low = min(min(a.y, b.y), c.y), high = max(max(a.y, b.y), c.y);
    float row_first = max(ceil(low - 0.5), 0.0), row_last = min(ceil(high - 0.5), size.y);
    for (float row = row_first; row < row_last; row += 1.0) {
        vec2 span = scan_row(a, b, c, row + 0.5);
        float column_last = min(ceil(span.y - 0.5), size.x);
        for (float column = max(ceil(span.x - 0.5), 0.0) + float(gl_LocalInvocationID.x); column < column_last;
             column += float(gl_WorkGroupSize.x)) {
            ivec2 pixel = ivec2(column, row);
            if (k_shadow) {
                write_texel(uint(row) * uint(size.x) + uint(column), ramp_at(ramp, vec2(pixel) + 0.5 - a));
                continue;
            }
            vec3 weight = weights_at(plane, a, vec2(pixel) + 0.5) * inverse_w;
            float sum = weight.x + weight.y + weight.z;
            vec3 share = weight / sum;  // perspective-correct
            vec3 normal = corners[0].normal * share.x + corners[1].normal * share.y + corners[2].normal * share.z;
            vec3 color = corners[0].color * share.x + corners[1].color * share.y + corners[2].color * share.z;
            float openness = dot(share, vec3(corners[0].openness, corners[1].openness, corners[2].openness));
            write_pixel(pixel, near_w * sum, pack_surface(normal, color, openness, leaf, pixel));
        }
    }
}

void main() {
    uint count = min(big_count, frame.big_triangle_limit);
    float near_w = frame.near_w;
    for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
        uvec2 reference = big[i];
        Transform t = load_transform(reference.y & ~k_ground_bit, (reference.y & k_ground_bit) != 0u);
        Corner corner[3];
        uint surface, kept = 0u;
        for (int v = 0; v < 3; ++v) {
            corner[v] = load_corner(t, reference.x + uint(v), surface);
            kept |= corner[v].place.z >= near_w ? 1u << v : 0u;
        }
        uint leaf = surface & k_leaf_bit;
        if (kept == 0u) continue;
        if (kept == 7u) {
            draw_triangle(corner, leaf);
            continue;
        }
        // Turn it so that the odd one out is corner 0.
        int odd = kept == 1u || kept == 6u ? 0 : kept == 2u || kept == 5u ? 1 : 2;
        int n1 = odd == 2 ? 0 : odd + 1, n2 = odd == 0 ? 2 : odd - 1;
        bool one = kept == 1u || kept == 2u || kept == 4u;  // the odd one is ahead
        Corner cut1, cut2;
        if (one) {
            cut1 = cut_edge(corner[n1], corner[odd]);
            cut2 = cut_edge(corner[n2], corner[odd]);
        } else {
            cut1 = cut_edge(corner[odd], corner[n1]);
            cut2 = cut_edge(corner[odd], corner[n2]);
        }
        Corner first[3] = Corner[3](one ? corner[odd] : corner[n1], one ? cut1 : corner[n2], one ? cut2 : cut1);
        draw_triangle(first, leaf);
        if (!one) {
            Corner second[3] = Corner[3](corner[n2], cut2, cut1);
            draw_triangle(second, leaf);
        }
    }
}
