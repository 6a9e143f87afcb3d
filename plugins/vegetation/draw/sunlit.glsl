// How much of the sun arrives at a place, by the shadow map: of the four texels around it those that nothing nearer to the sun
// covers, weighed by how near they are.
layout(constant_id = 4) const bool k_shadows = false;
layout(binding = 3) readonly buffer ShadowMap { uint shadow_map[]; };

// A texel says what covers its centre, so places are moved off their surface by so many texels along the normal, the more the sun
// grazes it, and towards the sun.
const float k_normal_offset = 1.0, k_sun_offset = 0.5;
// What of a plant hides the sun within that distance of a leaf, texels of so many m cannot tell: from there on its openness does, as
// without a map. Measured on woodland (docs/shadows.md).
const float k_unresolved_texel_m = 2.0;

// Shadows fade over the last of their distance.
const float k_fade_from = 0.8;

// place: relative to the viewer, along_m along the view. unknown: the share in the mean, as without a map; outside of the map it holds.
float sunlit_share(Light light, vec3 place, float along_m, vec3 normal, float unknown) {
    vec4 p = vec4(place, 1.0);
    float w = dot(light.shadow_w, p), inverse_w = 1.0 / w;
    vec3 at = vec3(dot(light.shadow_x, p), dot(light.shadow_y, p), dot(light.shadow_z, p)) * inverse_w;
    // How they grow along the two directions across the sun's, times w; along the sun's only depth does.
    vec2 column = light.shadow_growth_xy.xy - at.x * light.shadow_growth_wz.xy;
    vec2 row = light.shadow_growth_xy.zw - at.y * light.shadow_growth_wz.xy;
    vec2 depth = light.shadow_growth_wz.zw - at.z * light.shadow_growth_wz.xy;
    // The longer side of a texel, which need not be upright.
    float texel_m = w * sqrt(max(dot(column, column), dot(row, row))) / max(abs(column.x * row.y - column.y * row.x), 1.0e-20);
    float facing = dot(normal, light.to_sun.xyz);
    float off = sign(facing) * sqrt(max(1.0 - facing * facing, 0.0)) * k_normal_offset;
    vec2 off_across = vec2(dot(normal, light.sun_across.xyz), dot(normal, light.sun_along.xyz)) * off;
    float off_sunwards = facing * off + k_sun_offset;
    at += vec3(dot(column, off_across), dot(row, off_across), dot(depth, off_across) + light.sun_across.w * off_sunwards) * (texel_m * inverse_w);

    float side = light.sun_along.w;
    vec2 corner = at.xy - 0.5;
    if (!(w > 0.0 && all(greaterThanEqual(corner, vec2(0.0))) && all(lessThan(corner, vec2(side - 1.0))))) return unknown;
    vec2 first = floor(corner), share = corner - first;
    uint index = uint(first.y) * uint(side) + uint(first.x), below = index + uint(side);
    vec4 nearest = uintBitsToFloat(uvec4(shadow_map[index], shadow_map[index + 1u], shadow_map[below], shadow_map[below + 1u]));
    // What lies below the map's range is not hidden by a texel that nothing covers.
    vec4 open = mix(vec4(0.0), vec4(1.0), lessThanEqual(nearest, vec4(max(at.z, 0.0))));
    float sunlit = mix(mix(open.x, open.y, share.x), mix(open.z, open.w, share.x), share.y);
    sunlit *= mix(1.0, unknown, min(texel_m / k_unresolved_texel_m, 1.0));
    return mix(sunlit, unknown, smoothstep(k_fade_from, 1.0, along_m / light.horizon_color.w));
}
