#include "plugins/vegetation/eco/place.h"

namespace coppice {

PlantTurn make_turn(float turn_rad, float lean_rad, vec3 towards) {
    float yaw_sin = portable_sin(turn_rad * 0.5f), yaw_cos = portable_cos(turn_rad * 0.5f);
    float lean_sin = portable_sin(lean_rad * 0.5f), lean_cos = portable_cos(lean_rad * 0.5f);
    // The axis of leaning is up x towards; the product is lean * yaw.
    vec3 axis = vec3(towards.z, 0.0f, -towards.x) * lean_sin;
    return pack_turn(axis.x * yaw_cos - axis.z * yaw_sin, lean_cos * yaw_sin,
                     axis.z * yaw_cos + axis.x * yaw_sin, lean_cos * yaw_cos);
}

}  // namespace coppice
