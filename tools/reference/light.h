// The light model of draw/light.glsl, written anew: the reference may share no code with the shaders. Linear radiance;
// same bytes everywhere. Where a sunbeam is cut off is the caller's to say; the shaders have a stand-in for it.
#pragma once
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/plant/surface.h"

namespace coppice {

// The same light, its direction to the sun unit, or zero where there is no sun: what the functions below take.
Light with_unit_sun(Light light);

// What a surface sends to the viewer.
struct Shade {
    vec3 sun;  // of a sun that nothing hides; zero where its light cannot come through
    vec3 sky;  // of the sky past the own plant's parts, and of the ground
};
// surface: its normal in world space, as is to_viewer; both unit.
Shade shade(const Light& light, const Surface& surface, vec3 to_viewer);

// The share of Shade::sun that frames draw instead of a shadow. [0.12, 1].
float stand_in_sun(float openness);

vec3 sky_radiance(const Light& light, vec3 direction);

// The share of light that haze lets through: radiance L arrives as L * c + haze_color * (1 - c).
float clear_share(const Light& light, float distance_m);
vec3 apply_haze(const Light& light, vec3 radiance, float distance_m);

}  // namespace coppice
