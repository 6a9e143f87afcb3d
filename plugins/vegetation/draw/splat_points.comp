#version 460
// Points of one instance and part. A point covers the square of side size_px around it, that is, every pixel whose
// centre lies inside: size_px^2 pixels in the mean, also where the side is under a pixel, so the mean coverage is exact
// at any size. A point stands for the same area of leaf as any other; what is seen of it goes with |n . v|, and so does
// its square, so that what is shown is the mix of normals that the leaves show.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/raster.glsl"

layout(constant_id = 2) const uint k_side_limit = 1u;  // pixels a square can touch along one axis: 1, 2, or 0: any
// Leaves out points whose triangle is drawn. Clouds and points in place of lines carry a density: of those, what their
// place does not ask for; the others are as large as its lowest bits say (plant/line_points.h, pack_density).
layout(constant_id = 3) const bool k_blend = false;
layout(binding = 4) uniform utextureBuffer owners;

// A square that faced the viewer would be half in the ground below. It lies level, up to k_steepest, and bends towards the
// viewer by k_bend, for ground that is not level: m a metre. cull/horizon.cpp knows how near that may come.
const float k_steepest = 1.5, k_bend = 0.5;

// A rectangle of the shadow map, as large as the square that the point shows the sun.
void splat_shadow(Transform t, Entry entry, SunAxes axes, vec3 sun_plant, uvec4 vertex, uint owner) {
    vec3 position = uintBitsToFloat(vertex.xyz);
    vec3 p = project(t, position);
    if (!(p.z >= frame.near_w && all(lessThan(abs(p.xy), vec2(1.0e7))))) return;  // what is no number is nowhere
    float side_m = entry.size_px * t.scale;
    if (k_blend && entry.density_limit > 0.0) {
        vec3 from_viewer = t.place + turn_direction(t, position);
        float distance_m = max(length(from_viewer), frame.to_sun.w), along_m = max(dot(frame.viewer.xyz, from_viewer), frame.viewer.w * distance_m);
        if (uintBitsToFloat(owner) * along_m * along_m * along_m > entry.density_limit * distance_m) return;
        side_m = entry.size_px * metres_a_pixel(from_viewer, distance_m) * exp2((float(owner & 0xffu) - 128.0) / 32.0) *
                 sqrt(seen_gain(entry.owner_min, from_viewer.y / max(distance_m, 1.0e-30)));
    }
    vec3 normal = decode_normal(vertex.w);
    if (entry.mean_facing > 0.0) side_m *= sqrt(abs(dot(normal, sun_plant)) * inversesqrt(max(dot(normal, normal), 1.0e-30)));
    vec2 side = min(side_m * map_scale(axes, p), vec2(64.0));
    vec2 low = p.xy - 0.5 * side - 0.5;
    vec2 first = max(ceil(low), vec2(0.0)), last = min(ceil(low + side), frame.size_px);
    if (!(side_m > 0.0 && all(lessThan(first, last)))) return;
    float depth = depth_of(t, position, p.z);
    uint width = uint(frame.size_px.x), row = uint(first.y) * width + uint(first.x);
    uint columns = uint(last.x - first.x), end = row + width * uint(last.y - first.y);
    for (; row < end; row += width)
        for (uint i = 0u; i < columns; ++i) write_texel(row + i, depth);
}

void main() {
    uint index, first_item, step;
    if (!take_entry(index, first_item, step)) return;
    Entry entry = load_entry(index);
    Transform t = load_transform(entry.instance, entry.ground);
    ivec2 size = ivec2(frame.size_px);
    vec2 level = level_slope();
    float a_pixel = 1.0 / length(frame.row_x.xyz - dot(frame.row_x.xyz, frame.row_w.xyz) * frame.row_w.xyz);
    SunAxes axes = sun_axes();
    // Turned into the plant's space; t's rows are scaled.
    vec3 sun_plant = (t.turn_x * frame.to_sun.x + t.turn_y * frame.to_sun.y + t.turn_z * frame.to_sun.z) / max(t.scale, 1.0e-30);
    bool carries_density = k_blend && entry.density_limit > 0.0;

    for (uint i = first_item; i < entry.count; i += step) {
        uint owner = k_blend ? texelFetch(owners, int(entry.first_owner + i)).x : 0u;
        if (k_blend && !carries_density && owner < entry.owner_min) continue;
        uvec4 vertex = texelFetch(vertices, int(entry.first_vertex + i));
        if (k_shadow) {
            splat_shadow(t, entry, axes, sun_plant, vertex, owner);
            continue;
        }
        vec3 position = uintBitsToFloat(vertex.xyz);
        vec3 p = project(t, position);
        vec3 view = view_direction(t, position);
        float facing = abs(dot(unit_normal(t, vertex.w), view));
        // size_px is of a point that faces the viewer.
        float side_px = entry.mean_facing > 0.0 ? entry.size_px * sqrt(facing) : entry.size_px;
        if (carries_density) side_px *= sqrt(seen_gain(entry.owner_min, view.y)) * exp2((float(owner & 0xffu) - 128.0) / 32.0);
        int side = k_side_limit > 0u ? int(k_side_limit) : min(int(ceil(side_px)), 64);
        // First pixel whose centre lies inside, and how many more there are along each axis.
        vec2 low = p.xy - 0.5 * side_px - 0.5;
        vec2 first = ceil(low);
        ivec2 count = ivec2(ceil(low + side_px) - first);
        // What a plant there would ask for (cull/frustum.h, off_axis_stretch).
        if (carries_density && uintBitsToFloat(owner) * p.z * p.z * p.z > entry.density_limit * distance_to(t, position))
            continue;
        bool in_view = p.z >= frame.near_w && all(greaterThan(p.xy, vec2(-64.0))) &&
                       all(lessThan(p.xy, vec2(size) + 64.0));
        if (!in_view) continue;
        ivec2 corner = ivec2(first);
        uint surface = tint_surface(t, turn_surface(t, vertex.w, k_kind_point), vertex.x ^ vertex.y);
        float depth = frame.near_w / p.z;
        float height = dot(t.turn_y, position) + t.place.y;
        vec2 slope = level * (frame.near_w / height);
        slope *= min(1.0, k_steepest * a_pixel * depth / max(length(slope), 1.0e-30));
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                ivec2 pixel = corner + ivec2(x, y);
                vec2 beside = vec2(pixel) + 0.5 - p.xy;
                if (x < count.x && y < count.y && all(greaterThanEqual(pixel, ivec2(0))) &&
                    all(lessThan(pixel, size)))
                    write_pixel(pixel, clamp(depth * (1.0 + k_bend * a_pixel * length(beside)) + dot(slope, beside), 0.5 * depth, 1.0), surface);
            }
    }
}
