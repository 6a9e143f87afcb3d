#include "plugins/vegetation/load_planted_scene.h"

#include <algorithm>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/plant_scene.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

constexpr uint32_t k_picture_height_px =
    720;  // of the flight about a single plant, which a host does not fly

}  // namespace

Result<PlantedScene> load_planted_scene(const std::string& path, Registry& registry,
                                        const std::string& cache_dir) {
    for (const char* name : {"terrain", "modeller"}) COPPICE_CHECK(registry.load(name));
    const auto* terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    const std::string cache = cache_dir.empty() ? default_cache_dir() : cache_dir;
    const bool alone = is_plant_file(path);

    // Only textures and maps need pictures, and whoever has none need not have the plugin.
    const auto find_images = [&registry]() -> const ImagesInterface* {
        if (!registry.load("images")) return nullptr;
        return registry.find<ImagesInterface>(k_images_interface, k_images_version);
    };
    PlantedScene planted;
    if (alone) {
        planted.scene.models = {plant_scene_model(path)};
    } else {
        COPPICE_TRY(planted.scene, load_scene(path, {terrain, modeller, cache, {}, find_images, read_named_places}));
    }
    std::vector<PlantSource> sources;
    for (const SceneModel& model : planted.scene.models)
        sources.push_back({model.source_path, model.variation});
    const bool textured = std::ranges::any_of(sources, [](const PlantSource& source) {
        return !source.path.ends_with(".json") && !source.path.ends_with(".plant");
    });
    COPPICE_TRY(planted.plants, find_or_cook(cache, sources, CookSettings{}, modeller,
                                             textured ? find_images() : nullptr));

    std::vector<Box> bounds;
    for (const Plant& plant : planted.plants) bounds.push_back(plant.bounds_plant);
    if (alone) {
        COPPICE_TRY(planted.scene, make_plant_scene(path, bounds.front(), k_picture_height_px, terrain));
    }
    finish_tiles(planted.scene, bounds);
    if (planted.scene.terrain) shade_ground(planted.scene, *planted.scene.terrain, bounds);
    return planted;
}

}  // namespace coppice
