#include "plugins/vegetation/eco/read_light.h"

namespace coppice {

vec3 direction_to_sun(float azimuth_deg, float elevation_deg) {
    constexpr float k_radians = k_pi / 180.0f;
    const float azimuth = azimuth_deg * k_radians, elevation = elevation_deg * k_radians;
    return vec3(portable_sin(azimuth) * portable_cos(elevation), portable_sin(elevation),
                -portable_cos(azimuth) * portable_cos(elevation));
}

Light read_light(JsonObject& root) {
    Light light;
    if (const nlohmann::json* sun = root.find("sun"); sun && sun->is_null()) {
        light.direction_to_sun = vec3(0.0f);
    } else if (sun) {
        JsonObject object = root.object("sun");
        const float azimuth_deg = object.real("azimuth_deg", -360.0f, 360.0f, 137.0f);
        light.direction_to_sun =
            direction_to_sun(azimuth_deg, object.real("elevation_deg", -90.0f, 90.0f, 49.0f));
        light.sun_color = object.color("color", 100.0f, light.sun_color);
        object.close();
    }
    if (root.has("sky")) {
        JsonObject object = root.object("sky");
        light.sky_zenith_color = object.color("zenith", 100.0f, light.sky_zenith_color);
        light.sky_horizon_color = object.color("horizon", 100.0f, light.sky_horizon_color);
        light.ground_color = object.color("ground", 100.0f, light.ground_color);
        object.close();
    }
    if (root.has("haze")) {
        JsonObject object = root.object("haze");
        light.haze_color = object.color("color", 100.0f, light.haze_color);
        light.haze_density_per_m = object.real("density_per_m", 0.0f, 10.0f, light.haze_density_per_m);
        object.close();
    }
    light.exposure = root.real("exposure", 0.001f, 1000.0f, 1.0f);
    return light;
}

}  // namespace coppice
