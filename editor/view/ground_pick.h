// From the cursor to the ground, and back to the screen.
#pragma once
#include <optional>
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/components.h"

namespace coppice {

struct ViewSize {
    float width_px = 1.0f, height_px = 1.0f;
};

// Unit, world space.
vec3 ray_through(const Camera& camera, ViewSize size, vec2 cursor_px);
// Where the ray first meets the ground, at most 4 km away; null terrain: the plane y = 0.
std::optional<dvec3> pick_ground(const Camera& camera, ViewSize size, vec2 cursor_px, const Terrain* terrain);
// Of a place in front of the viewer.
std::optional<vec2> project(const Camera& camera, ViewSize size, dvec3 place_world);

}  // namespace coppice
