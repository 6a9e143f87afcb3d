// The ground's height anywhere in the world.
#pragma once
#include <functional>
#include "plugins/terrain/terrain.h"

namespace coppice {

// World y of the ground at (x, z), in metres.
using GroundHeight = std::function<double(double x_world, double z_world)>;

// World y in metres; without a terrain the ground is the plane y = 0.
inline double ground_height(const Terrain* terrain, double x_world, double z_world) {
    if (!terrain) return 0.0;
    dvec3 origin = terrain->origin_world();
    return origin.y + double(terrain->height_at(float(x_world - origin.x), float(z_world - origin.z)));
}

// The terrain must stay where it is.
inline GroundHeight height_of(const Terrain* terrain) {
    return [terrain](double x_world, double z_world) { return ground_height(terrain, x_world, z_world); };
}

inline vec3 ground_normal(const Terrain* terrain, double x_world, double z_world) {
    if (!terrain) return vec3(0, 1, 0);
    dvec3 origin = terrain->origin_world();
    return terrain->normal_at(float(x_world - origin.x), float(z_world - origin.z));
}

}  // namespace coppice
