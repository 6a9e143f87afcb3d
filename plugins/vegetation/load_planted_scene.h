// A scene with its plants, from the name of a file: all that a host needs before anything is drawn, and without graphics.
#pragma once
#include <string>
#include <vector>
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/plugin/registry.h"

namespace coppice {

struct PlantedScene {
    Scene scene;                // tiles finished; its terrain is of a plugin: destroy it before the registry
    std::vector<Plant> plants;  // of scene.models
};

// path: *.eco.json, or a plant (.glb, .gltf, species .json, .plant), which gets a grove. Loads the plugins that reading needs
// into the registry. Plants are cooked where cache_dir has none yet (seconds to minutes, on all cores) and kept there; empty:
// default_cache_dir(). Errors: load_scene's, find_or_cook's, Registry::load's.
Result<PlantedScene> load_planted_scene(const std::string& path, Registry& registry,
                                        const std::string& cache_dir = {});

}  // namespace coppice
