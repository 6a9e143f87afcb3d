// What of the document is drawn as a scene: rules, tiles, listed plants, ground and light; not the plants placed in the root,
// which change under the brush. What cannot be shown is left out and listed, or stands as a box.
#pragma once
#include <map>
#include "editor/document/document.h"
#include "plugins/modeller/modeller.h"
#include "plugins/images/images.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

struct BaseScene {
    Scene scene;                // its kinds are the root's
    std::vector<Plant> plants;  // one a model
    PlantKind box;              // for kinds that the scene lacks
    std::vector<Error> faults;
    double scene_ms = 0.0, plants_ms = 0.0,
           tiles_ms = 0.0;  // what reading, cooking or finding, and finishing took
};

struct BaseSceneSettings {
    const TerrainInterface* terrain = nullptr;
    const ModellerInterface* modeller = nullptr;
    std::function<const ImagesInterface*()> find_images;  // where a plant has textures
    std::string cache_dir;
};

// Errors: where not even an empty scene of it loads.
Result<BaseScene> make_base_scene(const Document& document, const BaseSceneSettings& settings);

// What is set of a plant's parts: as the document has it, or else as it stands beside the plant. Errors: those of reading it.
Result<std::vector<PartSettings>> part_settings_in(const Document& document, const std::string& plant_path);

// Changes where the base scene of the document does.
uint64_t hash_base(const Document& document);

}  // namespace coppice
