// How much of the sun arrives at a place, by the shadow map: of the four texels around it those that nothing nearer to the sun
// covers, weighed by how near they are.
layout(constant_id = 4) const bool k_shadows = false;
layout(binding = 3) readonly buffer ShadowMap { uint shadow_map[]; };

// Places are moved off their surface by so many texels, and towards the sun: a texel says what covers its centre.
const float k_normal_offset = 1.0, k_sun_offset = 0.5;

// place: relative to the viewer. Outside of the map `unknown`.
float sunlit_share(Light light, vec3 place, vec3 normal, float unknown) {
    vec4 p = vec4(place, 1.0);
    float w = dot(light.shadow_w, p);
    vec2 at = vec2(dot(light.shadow_x, p), dot(light.shadow_y, p)) / w;
    vec3 to_column = (light.shadow_x.xyz - at.x * light.shadow_w.xyz) / w;
    vec3 to_row = (light.shadow_y.xyz - at.y * light.shadow_w.xyz) / w;
    float texel_m = inversesqrt(max(min(dot(to_column, to_column), dot(to_row, to_row)), 1.0e-20));
    float facing = dot(normal, light.to_sun.xyz);
    vec3 off = normal * (sign(facing) * sqrt(max(1.0 - facing * facing, 0.0)) * k_normal_offset) + light.to_sun.xyz * k_sun_offset;
    p.xyz += off * texel_m;
    w = dot(light.shadow_w, p);
    at = vec2(dot(light.shadow_x, p), dot(light.shadow_y, p)) / w - 0.5;
    float depth = dot(light.shadow_z, p) / w;
    float side = light.shadow.x;
    if (!(w > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(side - 1.0))))) return unknown;
    vec2 first = floor(at), share = at - first;
    uint index = uint(first.y) * uint(side) + uint(first.x), below = index + uint(side);
    vec4 nearest = uintBitsToFloat(uvec4(shadow_map[index], shadow_map[index + 1u], shadow_map[below], shadow_map[below + 1u]));
    vec4 open = vec4(lessThanEqual(nearest, vec4(depth)));
    return mix(1.0, unknown, min(1.0, 0.5 * texel_m)) * mix(mix(open.x, open.y, share.x), mix(open.z, open.w, share.x), share.y);
}
