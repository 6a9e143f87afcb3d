// How much of the sun arrives at a place, by a shadow map: of the four texels around it those that nothing nearer to the sun
// covers, weighed by how near they are.
layout(constant_id = 4) const uint k_shadow_maps = 0u;  // none, one, or 2: several, nested
layout(binding = 1) readonly buffer Lights {
    Light light;
    // Of nested maps in their order: columns, rows, depths; and of maps of one sun those of the viewer, and how depths grow.
    vec4 nested_rows[3 * 12], nested_viewers[12];
};
const uint k_map_places = 12u;
layout(binding = 3) readonly buffer ShadowMap { uint shadow_map[]; };

// A texel says what covers its centre, so places are moved off their surface by so many texels along the normal, the more the sun
// grazes it, and towards the sun.
const float k_normal_offset = 1.0, k_sun_offset = 0.5;
// Of texels so large that a crown is a few of them. What its leaves hide of each other their openness says, and would count twice.
const float k_crown_texel_m = 1.5, k_crown_sun_offset = 2.5;
// What of a plant hides the sun within that distance of a leaf, texels of so many m cannot tell: from there on its openness does, as
// without a map. Measured on woodland (docs/shadows.md).
const float k_unresolved_texel_m = 2.0;

// Shadows fade over the last of their distance.
const float k_fade_from = 0.8;

// Of the texels around a place, (column, row, depth) of the map that begins with that texel; -1 outside.
float sunlit_at(vec3 at, uint first_texel, float side) {
    vec2 corner = at.xy - 0.5;
    if (!(all(greaterThanEqual(corner, vec2(0.0))) && all(lessThan(corner, vec2(side - 1.0))))) return -1.0;
    vec2 first = floor(corner), share = corner - first;
    uint index = first_texel + uint(first.y) * uint(side) + uint(first.x), below = index + uint(side);
    vec4 nearest = uintBitsToFloat(uvec4(shadow_map[index], shadow_map[index + 1u], shadow_map[below], shadow_map[below + 1u]));
    // What lies below the map's range is not hidden by a texel that nothing covers.
    vec4 open = mix(vec4(0.0), vec4(1.0), lessThanEqual(nearest, vec4(max(at.z, 0.0))));
    return mix(mix(open.x, open.y, share.x), mix(open.z, open.w, share.x), share.y);
}

// Moved off the surface along its normal, in texels.
float normal_offset(float facing) { return sign(facing) * sqrt(max(1.0 - facing * facing, 0.0)) * k_normal_offset; }

float sunlit_in_one(Light sun, vec3 place, vec3 normal, out float texel_m) {
    vec4 p = vec4(place, 1.0);
    float w = dot(sun.shadow_w, p), inverse_w = 1.0 / w;
    vec3 at = vec3(dot(sun.shadow_x, p), dot(sun.shadow_y, p), dot(sun.shadow_z, p)) * inverse_w;
    // How they grow along the two directions across the sun's, times w; along the sun's only depth does.
    vec2 column = sun.shadow_growth_xy.xy - at.x * sun.shadow_growth_wz.xy;
    vec2 row = sun.shadow_growth_xy.zw - at.y * sun.shadow_growth_wz.xy;
    vec2 depth = sun.shadow_growth_wz.zw - at.z * sun.shadow_growth_wz.xy;
    // The longer side of a texel, which need not be upright.
    texel_m = w * sqrt(max(dot(column, column), dot(row, row))) / max(abs(column.x * row.y - column.y * row.x), 1.0e-20);
    float facing = dot(normal, sun.to_sun.xyz), off = normal_offset(facing);
    vec2 off_across = vec2(dot(normal, sun.sun_across.xyz), dot(normal, sun.sun_along.xyz)) * off;
    float off_sunwards = facing * off + k_sun_offset;
    at += vec3(dot(column, off_across), dot(row, off_across), dot(depth, off_across) + sun.sun_across.w * off_sunwards) * (texel_m * inverse_w);
    return w > 0.0 ? sunlit_at(at, 0u, sun.sun_along.w) : -1.0;
}

// In the map for places so far from the viewer.
float sunlit_in_nested(Light sun, vec3 place, float distance_m, vec3 normal, out float texel_m) {
    float map = clamp(ceil(log2(distance_m / sun.nested.x)), 0.0, sun.nested.w);
    texel_m = sun.nested.y * exp2(map);
    float sun_offset = texel_m > k_crown_texel_m ? k_crown_sun_offset : k_sun_offset;
    vec4 p = vec4(place + (normal * normal_offset(dot(normal, sun.to_sun.xyz)) + sun.to_sun.xyz * sun_offset) * texel_m, 1.0);
    vec3 at;
    if (sun.zenith_color.w > 0.0) {  // a third of the reads
        vec4 viewer = nested_viewers[int(map)];
        vec3 first = vec3(dot(sun.shadow_x.xyz, p.xyz), dot(sun.shadow_y.xyz, p.xyz), dot(sun.shadow_z.xyz, p.xyz));
        at = viewer.xyz + first * vec3(vec2(exp2(-map)), viewer.w);
    } else {
        int rows = int(map) * 3;
        at = vec3(dot(nested_rows[rows], p), dot(nested_rows[rows + 1], p), dot(nested_rows[rows + 2], p));
    }
    float side = sun.sun_along.w;
    return sunlit_at(at, (uint(sun.nested.z + map) % k_map_places) * uint(side) * uint(side), side);
}

// place: relative to the viewer, along_m along the view. unknown: the share in the mean, as without a map; outside of the map it holds.
float sunlit_share(Light sun, vec3 place, float distance_m, float along_m, vec3 normal, float unknown) {
    float texel_m;
    float sunlit = k_shadow_maps > 1u ? sunlit_in_nested(sun, place, distance_m, normal, texel_m)
                                      : sunlit_in_one(sun, place, normal, texel_m);
    if (sunlit < 0.0) return unknown;
    sunlit *= mix(1.0, unknown, min(texel_m / k_unresolved_texel_m, 1.0));
    return mix(sunlit, unknown, smoothstep(k_fade_from, 1.0, along_m / sun.horizon_color.w));
}
