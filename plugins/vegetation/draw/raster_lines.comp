#version 460
// Lines of one instance and part, two vertices each; the second carries the line's own width over the part's mean.
// A line is a parallelogram cut along its steeper axis: at each step it covers the pixels whose centres lie within
// half its slanted width, so that it covers length * width in the mean at any direction and any width.
// Its pixels do not all show one normal: a stem shows those of the half of its surface that faces the viewer, and a
// leaf that stands for several shows normals turned about its axis in a share of its pixels.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"

// One of four normals, for a pixel: the line's own, or others about its axis.
struct LineNormals {
    uvec4 choice;
    vec4 limits;  // of a chance in [0, 1): below the first choice[0], and so on
};

LineNormals line_normals(Transform t, vec3 along_plant, vec3 begin_plant, uint surface, float share) {
    vec3 along = turn_direction(t, along_plant);
    along *= inversesqrt(max(dot(along, along), 1.0e-30));
    vec3 own = unit_normal(t, surface);
    vec3 view = view_direction(t, begin_plant);
    vec3 beside = cross(along, own);
    if ((surface & k_leaf_bit) != 0u) {
        vec3 half_way = own + beside, back = beside - own;  // both sides of a leaf can be seen: half a turn is enough
        // What is seen of a leaf goes with |n . v|.
        vec4 seen = abs(vec4(dot(own, view), 0.7071 * dot(half_way, view), dot(beside, view), 0.7071 * dot(back, view)));
        vec4 chances = share * seen / max(seen.x + seen.y + seen.z + seen.w, 1.0e-6);
        chances.x = 1.0 - chances.y - chances.z - chances.w;
        vec2 two = vec2(chances.x, chances.x + chances.y);
        return LineNormals(uvec4(encode_normal(own), encode_normal(half_way), encode_normal(beside), encode_normal(back)),
                           vec4(two, two.y + chances.z, 1.0));
    }
    // Places evenly spread over the visible width of a cylinder.
    vec3 front = along * dot(view, along) - view;
    float front_length = length(front);
    front = front_length > 0.0 ? front / front_length : own;
    beside = cross(along, front);
    return LineNormals(uvec4(encode_normal(0.968 * front + 0.25 * beside), encode_normal(0.968 * front - 0.25 * beside),
                             encode_normal(0.661 * front + 0.75 * beside), encode_normal(0.661 * front - 0.75 * beside)),
                       vec4(0.25, 0.5, 0.75, 1.0));
}

uint pick_normal(LineNormals normals, ivec2 pixel, uint line) {
    uint hash = uint(pixel.x) * 0x8da6b343u ^ uint(pixel.y) * 0xd8163841u ^ line * 0xcb1ab31fu;
    hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
    hash ^= hash >> 13;
    float chance = float(hash >> 8) * (1.0 / 16777216.0);
    return chance < normals.limits.x   ? normals.choice.x
           : chance < normals.limits.y ? normals.choice.y
           : chance < normals.limits.z ? normals.choice.z
                                       : normals.choice.w;
}

void main() {
    uint index, first_item, step;
    if (!take_entry(index, first_item, step)) return;
    Entry entry = load_entry(index);
    Transform t = load_transform(entry.instance, entry.ground);
    ivec2 size = ivec2(frame.size_px);
    float near_w = frame.near_w;
    SunAxes axes = sun_axes();

    for (uint i = first_item; i < entry.count; i += step) {
        uvec4 v0 = texelFetch(vertices, int(entry.first_vertex + i * 2u));
        uvec4 v1 = texelFetch(vertices, int(entry.first_vertex + i * 2u + 1u));
        vec4 p0 = vec4(uintBitsToFloat(v0.xyz), 1.0), p1 = vec4(uintBitsToFloat(v1.xyz), 1.0);
        float w0 = dot(t.to_w, p0), w1 = dot(t.to_w, p1);
        if (!(max(w0, w1) >= near_w)) continue;  // behind, or not a number
        // Cut at the near plane: the end behind it moves onto it.
        float cut = clamp((near_w - w0) / (w1 - w0), 0.0, 1.0);
        vec4 on_plane = mix(p0, p1, cut);
        if (w0 < near_w) { p0 = on_plane; w0 = near_w; }
        if (w1 < near_w) { p1 = on_plane; w1 = near_w; }
        vec2 a = vec2(dot(t.to_x, p0), dot(t.to_y, p0)) / w0;
        vec2 b = vec2(dot(t.to_x, p1), dot(t.to_y, p1)) / w1;
        vec2 depths = vec2(depth_of(t, p0.xyz, w0), depth_of(t, p1.xyz, w1));

        bool steep = abs(b.y - a.y) > abs(b.x - a.x);
        if (steep) { a = a.yx; b = b.yx; }
        if (a.x > b.x) { vec2 swap = a; a = b; b = swap; depths = depths.yx; }
        vec2 limit = vec2(steep ? size.yx : size);
        float span = b.x - a.x;
        if (!(span < 1.0e7 && abs(a.y) + abs(b.y) < 1.0e7)) continue;  // overflowed: coordinates no plant has
        float slope = span > 0.0 ? (b.y - a.y) / span : 0.0;
        float depth_slope = span > 0.0 ? (depths.y - depths.x) / span : 0.0;
        uint surface = tint_surface(t, turn_surface(t, v0.w, k_kind_line), v0.x ^ v0.y) & ~k_normal_bits;
        LineNormals normals =
            line_normals(t, p1.xyz - p0.xyz, p0.xyz, v0.w, uintBitsToFloat(entry.owner_min));
        float width_px = entry.size_px * uintBitsToFloat(v1.w);
        if (k_shadow) {
            // As wide as the strip that covers as much of the map as the line covers seen from the sun.
            vec2 scale = map_scale(axes, vec3(0.5 * (steep ? a.yx + b.yx : a + b), 0.5 * (w0 + w1)));
            float across_m = length(cross(turn_direction(t, p1.xyz - p0.xyz), frame.to_sun.xyz));
            width_px *= t.scale * scale.x * scale.y * across_m / max(length(b - a), 1.0e-6);
        }
        float width = min(width_px * sqrt(1.0 + slope * slope), 64.0);

        float first = max(ceil(a.x - 0.5), 0.0), last = min(ceil(b.x - 0.5), limit.x);
        for (float column = first; column < last; column += 1.0) {
            float along = column + 0.5 - a.x;
            float low = a.y + slope * along - 0.5 * width - 0.5;
            float depth = depths.x + depth_slope * along;
            float row_first = max(ceil(low), 0.0), row_last = min(ceil(low + width), limit.y);
            for (float row = row_first; row < row_last; row += 1.0) {
                ivec2 pixel = ivec2(column, row);
                if (steep) pixel = pixel.yx;
                if (k_shadow)
                    write_texel(uint(pixel.y) * uint(frame.size_px.x) + uint(pixel.x), depth);
                else
                    write_pixel(pixel, depth, surface | pick_normal(normals, steep ? pixel.yx : pixel, i));
            }
        }
    }
}
