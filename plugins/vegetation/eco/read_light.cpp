#include "plugins/vegetation/eco/read_light.h"

namespace coppice {

Light read_light(JsonObject& root) {
    constexpr float k_radians = k_pi / 180.0f;
    Light light;
    if (const nlohmann::json* sun = root.find("sun"); sun && sun->is_null()) {
        light.direction_to_sun = vec3(0.0f);
    } else if (sun) {
        JsonObject object = root.object("sun");
        float azimuth = object.real("azimuth_deg", -360.0f, 360.0f, 137.0f) * k_radians;
        float elevation = object.real("elevation_deg", -90.0f, 90.0f, 49.0f) * k_radians;
        light.direction_to_sun =
            vec3(portable_sin(azimuth) * portable_cos(elevation), portable_sin(elevation),
                 -portable_cos(azimuth) * portable_cos(elevation));
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
