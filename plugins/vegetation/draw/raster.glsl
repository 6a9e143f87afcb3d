// What the raster kernels share: the frame's constants, the work list, the transform, and the write of one pixel into
// the visibility buffer or, with k_shadow, into the shadow map. Lists are in DESIGN section 4; entries are written by
// draw/work_list.cpp (same layout).
//
// World coordinates are relative to the camera. With p = (place, 1) a point's column and row on the image are
// dot(row_x, p) / w and dot(row_y, p) / w with w = dot(row_w, p). In the picture w is the distance along the view, and depth is
// near / w in (0, 1]: 0 is far. In the shadow map (shadow/shadow_view.h) depth is dot(row_z, p) / w, 1 is nearest to the sun.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "plugins/vegetation/draw/surface.glsl"

layout(local_size_x_id = 0) in;
// false: a group takes one entry and its lanes share the primitives. true: a lane takes one entry of few primitives
// (MEASURED: many tiny instances).
layout(constant_id = 1) const bool k_entry_a_lane = false;

layout(constant_id = 4) const bool k_shadow = false;
layout(constant_id = 5) const bool k_tinted = false;  // instances carry tints (draw/work_list.h, set_tint)

layout(push_constant) uniform Frame {
    vec4 row_x, row_y, row_w;
    // Of the shadow map only.
    vec4 row_z;
    vec4 to_sun;             // w: what throws shadows is as coarse as from so far away at least
    vec4 viewer;             // the view's axis; w: cosine of the picture's corners
    vec2 size_px;            // width and height of the image
    float near_w;            // what has less is cut off
    float metres_a_pixel;    // of the shadow map: in the picture, at a distance of 1 m along the axis
    uint first_entry;
    uint entry_count;
    uint view;               // RepresentationView of lod/settings.h: colours say what was drawn
    uint big_triangle_limit; // capacity of the list of big triangles
} frame;

layout(binding = 0) buffer Visibility { uint64_t visibility[]; };
layout(binding = 0) buffer ShadowMap { uint shadow_map[]; };  // k_shadow: in place of the other
layout(binding = 1) uniform utextureBuffer vertices;  // xyz: position in plant space as float bits, w: surface
layout(binding = 2) uniform utextureBuffer entries;   // two texels an entry
layout(binding = 3) uniform textureBuffer instances;  // two texels an instance: foot and scale, quaternion

const uint k_ground_bit = 0x80000000u;  // of an entry's instance: no plant
const uint k_view_lit = 0u, k_view_kinds = 1u;

struct Entry {
    uint first_vertex, count, instance, first_owner;
    float size_px;   // splat side or line width; in the shadow map in metres of the plant, but of points that carry a density
    uint owner_min;  // of points that carry a density their height gain, of lines the share that is turned, of leaves the level
    bool cull_back;   // of triangles
    bool ground;
    float mean_facing;    // of points: |cos| of normal and view in the mean; 0: all are of one size
    float density_limit;  // PartChoice::density_limit_m2; 0: points carry no density
    uint grid;            // of leaves: where the part's LeafGrid is
};

// The entry of this lane, false where there is none; its primitives are i = first; i < count; i += step.
bool take_entry(out uint index, out uint first, out uint step) {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    // A CPU device cuts the groups into as many runs as it has threads; entries come nearest first, and near ones cost
    // more. So the second half of the groups takes every other entry (MEASURED: Lavapipe).
    uint groups = k_entry_a_lane ? (frame.entry_count + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x : frame.entry_count;
    uint half_groups = (groups + 1u) / 2u;
    group = group < half_groups ? 2u * group : group < groups ? 2u * (group - half_groups) + 1u : group;
    index = k_entry_a_lane ? group * gl_WorkGroupSize.x + gl_LocalInvocationID.x : group;
    first = k_entry_a_lane ? 0u : gl_LocalInvocationID.x;
    step = k_entry_a_lane ? 1u : gl_WorkGroupSize.x;
    bool any = index < frame.entry_count;
    index += frame.first_entry;
    return any;
}

Entry load_entry(uint index) {
    uvec4 a = texelFetch(entries, int(index * 2u));
    uvec4 b = texelFetch(entries, int(index * 2u + 1u));
    return Entry(a.x, a.y, a.z & ~k_ground_bit, a.w, uintBitsToFloat(b.x), b.y, b.z != 0u, (a.z & k_ground_bit) != 0u, uintBitsToFloat(b.w), uintBitsToFloat(b.z), b.z);
}

// Plant space -> (column * w, row * w, w), and the rotation for normals.
struct Transform {
    vec4 to_x, to_y, to_w, to_z;
    vec3 turn_x, turn_y, turn_z;
    vec3 place;  // of the plant's origin
    float scale;
    bool ground;
    vec3 tint;  // b, p and q of eco/vary_color.h
};

Transform load_transform(uint instance, bool ground) {
    vec4 foot = texelFetch(instances, int(instance * 2u));
    vec4 q = texelFetch(instances, int(instance * 2u + 1u));
    // rotation_matrix of components.h, row by row: plant -> world.
    vec4 x = vec4(foot.w * vec3(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z), 2.0 * (q.x * q.z + q.w * q.y)), foot.x);
    vec4 y = vec4(foot.w * vec3(2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x)), foot.y);
    vec4 z = vec4(foot.w * vec3(2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)), foot.z);
    Transform t;
    t.to_x = frame.row_x.x * x + frame.row_x.y * y + frame.row_x.z * z;
    t.to_y = frame.row_y.x * x + frame.row_y.y * y + frame.row_y.z * z;
    t.to_w = frame.row_w.x * x + frame.row_w.y * y + frame.row_w.z * z;
    t.to_z = frame.row_z.x * x + frame.row_z.y * y + frame.row_z.z * z;
    t.to_x.w += frame.row_x.w;
    t.to_y.w += frame.row_y.w;
    t.to_w.w += frame.row_w.w;
    t.to_z.w += frame.row_z.w;
    t.turn_x = x.xyz;
    t.turn_y = y.xyz;
    t.turn_z = z.xyz;
    t.place = vec3(x.w, y.w, z.w);
    t.scale = foot.w;
    t.ground = ground;
    t.tint = vec3(1.0, 1.0, 0.0);
    if (k_tinted) {
        ivec4 bits = floatBitsToInt(q) & 63;
        int tint = bits.x | bits.y << 6 | bits.z << 12 | bits.w << 18;
        t.tint += vec3(ivec3(tint << 24, tint << 16, tint << 8) >> 24) * vec3(1.0 / 128.0, 1.0 / 128.0, 1.0 / 64.0);
    }
    return t;
}

// (column, row) in pixels and w.
vec3 project(Transform t, vec3 position) {
    vec4 p = vec4(position, 1.0);
    float w = dot(t.to_w, p);
    return vec3(vec2(dot(t.to_x, p), dot(t.to_y, p)) / w, w);
}

// Of a place with that w.
float depth_of(Transform t, vec3 position, float w) {
    return k_shadow ? dot(t.to_z, vec4(position, 1.0)) / w : frame.near_w / w;
}

const uint k_kind_point = 0u, k_kind_line = 1u, k_kind_triangle = 2u, k_kind_leaf = 3u;

vec3 turn_direction(Transform t, vec3 direction) {
    return vec3(dot(t.turn_x, direction), dot(t.turn_y, direction), dot(t.turn_z, direction));
}

// Unit, from the viewer.
vec3 view_direction(Transform t, vec3 position_plant) {
    vec3 p = t.place + turn_direction(t, position_plant);
    return p * inversesqrt(max(dot(p, p), 1.0e-30));
}

float distance_to(Transform t, vec3 position_plant) {
    return length(t.place + turn_direction(t, position_plant));
}

// Of the shadow map: how columns, rows and w grow along two directions at right angles to the sun's, along which none of them
// changes.
struct SunAxes {
    vec2 column, row, w;
};

SunAxes sun_axes() {
    vec3 to_sun = frame.to_sun.xyz;
    vec3 across = normalize(abs(to_sun.y) < 0.9 ? vec3(to_sun.z, 0.0, -to_sun.x) : vec3(0.0, -to_sun.z, to_sun.y));
    vec3 along = cross(to_sun, across);
    return SunAxes(vec2(dot(frame.row_x.xyz, across), dot(frame.row_x.xyz, along)),
                   vec2(dot(frame.row_y.xyz, across), dot(frame.row_y.xyz, along)),
                   vec2(dot(frame.row_w.xyz, across), dot(frame.row_w.xyz, along)));
}

// How many columns and rows a square metre that faces the sun is at a place of the map: as much area, upright.
vec2 map_scale(SunAxes axes, vec3 place_on_map) {
    vec2 column = axes.column - place_on_map.x * axes.w, row = axes.row - place_on_map.y * axes.w;
    float across = length(column), inverse_w = 1.0 / place_on_map.z;
    return vec2(across, abs(column.x * row.y - column.y * row.x) / max(across, 1.0e-30)) * inverse_w;
}

// What a pixel of the picture is at that place (cull/frustum.h, off_axis_stretch).
float metres_a_pixel(vec3 from_viewer, float distance_m) {
    float cosine = max(dot(frame.viewer.xyz, from_viewer) / max(distance_m, 1.0e-30), frame.viewer.w);
    return frame.metres_a_pixel * distance_m * cosine * sqrt(cosine);
}

// plant/plant.h, of two numbers as draw/work_list.cpp packs them.
float seen_gain(uint height_gain, float height) {
    vec2 gain = unpackSnorm2x16(height_gain) * 4.0;
    float square = height * height;
    return clamp(1.0 + gain.x * (1.5 * square - 0.5) + gain.y * ((4.375 * square - 3.75) * square + 0.375), 0.1, 1.6);
}

// Of what lies level: by how much 1 / w grows a column and a row, times its height over the viewer.
vec2 level_slope() {
    vec3 across = cross(frame.row_y.xyz, frame.row_w.xyz), along = cross(frame.row_w.xyz, frame.row_x.xyz);
    return vec2(across.y, along.y) / dot(frame.row_x.xyz, across);
}

vec3 unit_normal(Transform t, uint surface) {
    vec3 n = turn_direction(t, decode_normal(surface));
    return n * inversesqrt(max(dot(n, n), 1.0e-30));
}

// eco/vary_color.cpp.
vec3 tint_color(Transform t, vec3 c) {
    float mean = (c.x + c.y + c.z) * (1.0 / 3.0);
    return t.tint.x * (mean + t.tint.y * (c - mean) + (t.tint.z * 0.57735027) * (c.zxy - c.yzx));
}

// The surface in the plant's colours. place: any bits that tell primitives or pixels apart, by which colours are rounded.
uint tint_surface(Transform t, uint surface, uint place) {
    if (!k_tinted) return surface;
    uint hash = place * 0x9e3779b9u ^ floatBitsToUint(t.tint.x + t.tint.y);
    hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
    hash ^= hash >> 13;
    return (surface & ~k_color_bits) | encode_color(tint_color(t, decode_color_linear(surface)), float(int(hash >> 8)) * (1.0 / 16777216.0));
}

// Turns a surface word from plant space into world space.
uint turn_surface(Transform t, uint surface, uint kind) {
    vec3 n = decode_normal(surface);
    uint turned = encode_normal(turn_direction(t, n));
    uint kind_color = kind == k_kind_point ? 0x0000f000u | 0x0001f000u : kind == k_kind_line ? 0x0f800000u : kind == k_kind_leaf ? 0x007ff000u : 0x007e0000u;
    uint plant_color = t.ground ? 0u : k_color_bits;
    uint color = frame.view == k_view_lit ? surface & k_color_bits : frame.view == k_view_kinds ? kind_color : plant_color;
    return (surface & ~(k_normal_bits | k_color_bits)) | turned | color;
}

// The nearer surface wins; ties go to the larger word, so the order of work never shows. Reading the depth first spares
// most atomics where much is hidden (MEASURED: rasterising); it only grows, so an old value is safe to go by.
void write_pixel(ivec2 pixel, float depth, uint surface) {
    uint index = uint(pixel.y) * uint(frame.size_px.x) + uint(pixel.x);
    uint depth_bits = floatBitsToUint(depth);
    if (uint(visibility[index] >> 32) <= depth_bits)
        atomicMax(visibility[index], uint64_t(depth_bits) << 32 | uint64_t(surface));
}

// Into the shadow map. What is nearer to the sun than the map begins lies on its border.
void write_texel(uint index, float depth) {
    uint depth_bits = floatBitsToUint(clamp(depth, 0.0, 1.0));
    if (shadow_map[index] < depth_bits) atomicMax(shadow_map[index], depth_bits);
}
