// A scene for a plant that has none: itself in front, a grove of it behind, on flat ground; the flight goes
// from where the plant fills the picture to where it is 20 pixels tall.
#pragma once
#include <string>
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

// By its ending: .glb, .gltf, .plant, and .json that is not .eco.json.
bool is_plant_file(const std::string& path);

// The only model of the scene, known before the plant is.
SceneModel plant_scene_model(const std::string& path);

// bounds_plant: of the packed plant, not empty; everything follows from its size, and the middle of its
// lowest face stands on the ground, wherever its author put the origin. picture_height_px > 0. terrain may be
// null: the ground is not drawn then. Deterministic; like load_scene's, the tiles wait for finish_tiles.
Result<Scene> make_plant_scene(const std::string& path, const Box& bounds_plant, uint32_t picture_height_px,
                               const TerrainInterface* terrain);

}  // namespace coppice
