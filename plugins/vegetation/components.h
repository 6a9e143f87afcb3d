// What a plant, an eco tile, a camera and a light carry. 32 bytes a plant in three components.
#pragma once
#include <cstdint>
#include "runtime/core/math.h"

namespace coppice {

struct PlantPosition {
    static constexpr const char* k_component_name = "plant position";
    float x_tile, y_tile, z_tile;  // m, from the tile's origin, foot of the plant
    float scale;                   // > 0
};

// Unit quaternion, each part times 32767. Turns plant space into world space.
struct PlantTurn {
    static constexpr const char* k_component_name = "plant turn";
    int16_t x, y, z, w;
};

struct PlantModel {
    static constexpr const char* k_component_name = "plant model";
    uint32_t model;  // index into Scene::models
    uint32_t seed;   // any well mixed bits; decides fractions of primitives
};

inline constexpr float k_turn_step = 1.0f / 32767.0f;
// Plant space to world space; its transpose turns back. draw/see_plants.cpp and draw/raster.glsl have it as well.
inline mat3 rotation_matrix(PlantTurn turn) {
    const float x = float(turn.x) * k_turn_step, y = float(turn.y) * k_turn_step;
    const float z = float(turn.z) * k_turn_step, w = float(turn.w) * k_turn_step;
    return mat3(vec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
                vec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
                vec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)));
}
PlantTurn pack_turn(float x, float y, float z, float w);
inline PlantTurn pack_turn_about_y(float angle_rad) {
    return pack_turn(0.0f, portable_sin(angle_rad * 0.5f), 0.0f, portable_cos(angle_rad * 0.5f));
}

// Of the entity that owns a tile's chunk, or stands for one that is not in memory. Bounds are relative to the origin and
// hold all its plants at full size.
struct Tile {
    static constexpr const char* k_component_name = "tile";
    dvec3
        origin_world;  // counted from where its scene stands, which may be in several places: TileLevels::target
    Box bounds_tile;
    uint64_t plant_count = 0;
};

// What stands for a tile in the distance, and what it consists of; beside Tile. All tiles of a world are one chunk, row 0
// holds all others, and a tile's children follow each other. A tile is one of three: a leaf, whose plants are a chunk that
// it owns, while they are in memory; a parent of children; or a place, where another row's scene stands, at its origin.
struct TileLevels {
    static constexpr const char* k_component_name = "tile levels";
    static constexpr uint32_t k_none = UINT32_MAX;
    uint32_t cloud = k_none;                    // of the clouds that can be drawn; none: not in memory
    uint32_t first_child = 0, child_count = 0;  // rows
    uint32_t target = k_none;                   // a row: this one is a place
    float finest_density = 0.0f;                // the cloud suffices up to (pixels a metre / d')^2
    uint32_t is_streamed = 0;                   // its blocks come from a file: they may be asked for
    uint64_t triangle_count = 0;                // of all its plants
};

struct Camera {
    dvec3 position_world{0.0, 1.7, 0.0};
    float yaw_rad = 0.0f;    // 0 looks along -z, positive turns left (counter-clockwise seen from above)
    float pitch_rad = 0.0f;  // positive looks up
    float vertical_fov_rad = 1.0471976f;
    float near_m = 0.1f;
    float roll_rad = 0.0f;  // positive tips the head to the left: the picture turns clockwise
    vec3 forward() const;
    vec3 right() const;
    vec3 up() const;
    bool operator==(const Camera&) const = default;
};

// The camera that looks along `forward` with `up` upwards, for hosts that have axes or a matrix: the rows of a view matrix
// are right, up and -forward. Both need not be unit, nor at right angles; what is zero or no number is taken as -z and y.
Camera camera_along(dvec3 position_world, vec3 forward, vec3 up, float vertical_fov_rad, float near_m);

// Sun, sky and haze. Radiances are linear, 1 is white on the screen after exposure.
struct Light {
    vec3 direction_to_sun = vec3(0.45f, 0.75f, 0.48f);  // normalised when used; zero: no sun
    vec3 sun_color = vec3(3.0f, 2.75f, 2.35f);          // irradiance at a right angle, over pi
    vec3 sky_zenith_color = vec3(0.20f, 0.38f, 0.75f);
    vec3 sky_horizon_color = vec3(0.62f, 0.74f, 0.88f);
    vec3 ground_color = vec3(0.10f, 0.10f, 0.06f);  // light from below
    vec3 haze_color = vec3(0.62f, 0.72f, 0.84f);
    float haze_density_per_m = 0.0006f;  // 0: none
    float exposure = 1.0f;
    bool operator==(const Light&) const = default;
};

}  // namespace coppice
