// The light model, linear radiance.
// A leaf shows the side towards the viewer; light that falls on its other side comes through, tinted by it twice.
// Openness, the share of sky a place sees past its own plant, weighs the sky's light.
#ifndef COPPICE_LIGHT_GLSL
#define COPPICE_LIGHT_GLSL

struct Light {
    vec4 to_sun;        // unit; w: exposure
    vec4 sun_color;     // w: haze density, 1/m
    vec4 zenith_color;  // w: 1 where all nested maps are of one sun
    vec4 horizon_color; // w: how far along the view shadows are seen, m
    vec4 ground_color;
    vec4 haze_color;
    // Of the shadow map (shadow/shadow_view.h).
    vec4 shadow_x, shadow_y, shadow_z, shadow_w;
    vec4 sun_across, sun_along;  // unit, at right angles to the sun and each other; w: how shadow_z grows towards the sun; texels a side
    vec4 shadow_growth_xy, shadow_growth_wz;  // how columns and rows, w and depths, all times w, grow along the two
    // Of nested maps (shadow/clipmap.h): how far the first is looked up and how large its texels are, m, its place, and how many
    // follow it.
    vec4 nested;
};

// Of the sun's light in the mean, where no shadow map says: a sunbeam crosses the crown once more than the mean of the sky does.
float stand_in_sun(float openness) { return mix(0.12, 1.0, openness * openness); }

vec3 sky_radiance(Light light, vec3 direction) {
    float up = clamp(direction.y, 0.0, 1.0);
    vec3 sky = mix(light.horizon_color.rgb, light.zenith_color.rgb, sqrt(up));
    float toward = max(dot(direction, light.to_sun.xyz), 0.0);
    float power4 = toward * toward * toward * toward, power8 = power4 * power4, power32 = power8 * power8 * power8 * power8;
    float power256 = power32 * power32 * power32 * power32;
    power256 *= power256;
    return sky + light.sun_color.rgb * (0.06 * power8 + 0.25 * power256);
}

// sunlit: the share of the sun's light that arrives.
vec3 shade(Light light, vec3 normal, vec3 to_viewer, vec3 color, float openness, float sunlit, bool leaf) {
    bool turned = leaf && dot(normal, to_viewer) < 0.0;
    normal = turned ? -normal : normal;
    float facing = dot(normal, light.to_sun.xyz);
    float reflected = max(facing, 0.0);
    float passed = leaf ? max(-facing, 0.0) : 0.0;
    // Young green: what leaves let through is yellower and more saturated than what they throw back.
    vec3 passed_color = min(color * vec3(1.25, 1.35, 0.55), vec3(1.0));
    vec3 sun = light.sun_color.rgb * (color * reflected + passed_color * 0.8 * passed);
    float up = 0.5 + 0.5 * normal.y;
    vec3 sky = mix(light.ground_color.rgb, mix(light.horizon_color.rgb, light.zenith_color.rgb, 0.5), up);
    return sun * sunlit + color * sky * openness;
}

vec3 apply_haze(Light light, vec3 radiance, vec3 direction, float distance_m) {
    float clear = exp(-light.sun_color.w * distance_m);
    vec3 haze = light.haze_color.rgb;
    return mix(haze, radiance, clear);
}

// Linear light in [0, 1] to sRGB: a fit in square roots, within 0.00005 of the exact curve and several times faster on
// a CPU.
vec3 encode_srgb(vec3 c) {
    vec3 root2 = sqrt(c), root4 = sqrt(root2), root8 = sqrt(root4);
    vec3 high = 0.642366232 * root2 + 0.712109783 * root4 - 0.336869640 * root8 - 0.0175633330 * c;
    return clamp(mix(high, c * 12.92, lessThanEqual(c, vec3(0.0031308))), 0.0, 1.0);
}

// Radiance to what the screen takes: a filmic curve with a toe and a shoulder (the rational fit of Narkowicz 2015).
vec3 present(Light light, vec3 radiance) {
    vec3 c = radiance * light.to_sun.w;
    return encode_srgb(clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0));
}

#endif
