#version 460
// Lines of one instance and part, two vertices each; the second carries the line's own width over the part's mean.
// A line is a parallelogram cut along its steeper axis: at each step it covers the pixels whose centres lie within
// half its slanted width, so that it covers length * width in the mean at any direction and any width.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"

void main() {
    uint index, first_item, step;
    if (!take_entry(index, first_item, step)) return;
    Entry entry = load_entry(index);
    Transform t = load_transform(entry.instance, entry.ground);
    ivec2 size = ivec2(frame.row_x.w, frame.row_y.w);
    float near_m = frame.row_w.w;

    for (uint i = first_item; i < entry.count; i += step) {
        uvec4 v0 = texelFetch(vertices, int(entry.first_vertex + i * 2u));
        uvec4 v1 = texelFetch(vertices, int(entry.first_vertex + i * 2u + 1u));
        vec4 p0 = vec4(uintBitsToFloat(v0.xyz), 1.0), p1 = vec4(uintBitsToFloat(v1.xyz), 1.0);
        float w0 = dot(t.to_w, p0), w1 = dot(t.to_w, p1);
        if (!(max(w0, w1) >= near_m)) continue;  // behind, or not a number
        // Cut at the near plane: the end behind it moves onto it.
        float cut = clamp((near_m - w0) / (w1 - w0), 0.0, 1.0);
        vec4 on_plane = mix(p0, p1, cut);
        if (w0 < near_m) { p0 = on_plane; w0 = near_m; }
        if (w1 < near_m) { p1 = on_plane; w1 = near_m; }
        vec2 a = vec2(dot(t.to_x, p0), dot(t.to_y, p0)) / w0;
        vec2 b = vec2(dot(t.to_x, p1), dot(t.to_y, p1)) / w1;
        vec2 depths = near_m / vec2(w0, w1);

        bool steep = abs(b.y - a.y) > abs(b.x - a.x);
        if (steep) { a = a.yx; b = b.yx; }
        if (a.x > b.x) { vec2 swap = a; a = b; b = swap; depths = depths.yx; }
        vec2 limit = vec2(steep ? size.yx : size);
        float span = b.x - a.x;
        if (!(span < 1.0e7 && abs(a.y) + abs(b.y) < 1.0e7)) continue;  // overflowed: coordinates no plant has
        float slope = span > 0.0 ? (b.y - a.y) / span : 0.0;
        float depth_slope = span > 0.0 ? (depths.y - depths.x) / span : 0.0;
        float width = min(entry.size_px * uintBitsToFloat(v1.w) * sqrt(1.0 + slope * slope), 64.0);
        uint surface = turn_surface(t, v0.w, k_kind_line);

        float first = max(ceil(a.x - 0.5), 0.0), last = min(ceil(b.x - 0.5), limit.x);
        for (float column = first; column < last; column += 1.0) {
            float along = column + 0.5 - a.x;
            float low = a.y + slope * along - 0.5 * width - 0.5;
            float depth = depths.x + depth_slope * along;
            float row_first = max(ceil(low), 0.0), row_last = min(ceil(low + width), limit.y);
            for (float row = row_first; row < row_last; row += 1.0) {
                ivec2 pixel = ivec2(column, row);
                write_pixel(steep ? pixel.yx : pixel, depth, surface);
            }
        }
    }
}
