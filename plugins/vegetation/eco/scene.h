// A scene in memory: what an *.eco.json file says, with its placements cut into square tiles.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/eco/place.h"
#include "plugins/vegetation/eco/vary_color.h"
#include "runtime/core/result.h"

namespace coppice {

struct SceneModel {
    std::string name;         // as the scene names it
    std::string source_path;  // .glb, .gltf or species .json, resolved against the scene file
    uint64_t variation = 0;   // of a species: which individual
    float importance = 1.0f;  // multiplies the importance of all its parts
    ColorVariation color_variation = {};
};

// Plants of one tile: rows [first_plant, first_plant + plant_count) of the arrays in Scene.
struct SceneTile {
    Tile tile;
    uint32_t first_plant, plant_count;
};

struct CameraKey {
    double time_s;
    Camera camera;
};

struct Scene {
    std::string name, path;
    std::vector<SceneModel> models;
    std::map<std::string, PlantKind> kinds;  // what the file itself may plant, by name; for who places more
    std::vector<SceneTile> tiles;
    std::vector<PlantPosition> positions;
    std::vector<PlantTurn> turns;
    std::vector<PlantModel> plant_models;
    Light light;
    std::shared_ptr<Terrain> terrain;    // may be null; shade_ground darkens it
    std::vector<CameraKey> camera_path;  // sorted by time; at least one key
    float sample_distance_px = 1.0f;     // d' the author recommends
};

// Smooth between the keys (cubic, no overshoot in time), clamped at the ends.
Camera camera_at(const std::vector<CameraKey>& path, double time_s);

}  // namespace coppice
