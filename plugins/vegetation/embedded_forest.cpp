#include "plugins/vegetation/embedded_forest.h"

#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/load_planted_scene.h"

namespace coppice {

EmbeddedForest::~EmbeddedForest() = default;

Result<std::unique_ptr<EmbeddedForest>> EmbeddedForest::create(const EmbeddedForestSettings& settings) {
    std::unique_ptr<EmbeddedForest> forest(new EmbeddedForest);
    COPPICE_TRY(forest->device_, gpu::Device::adopt(settings.device));
    COPPICE_TRY(forest->vegetation_,
                create_vegetation({forest->device_.get(), &forest->world_, &forest->schedule_,
                                   &forest->graph_, settings.frame_slots, settings.width, settings.height}));
    COPPICE_CHECK(forest->load(settings));
    return forest;
}

Status EmbeddedForest::load(const EmbeddedForestSettings& settings) {
    const std::string populated = populated_scene_file(settings.scene);
    if (populated.empty()) {
        COPPICE_TRY(PlantedScene planted, load_planted_scene(settings.scene, registry_, settings.cache_dir));
        scene_ = std::move(planted.scene);
        return vegetation_->set_scene(scene_, std::move(planted.plants));
    }
    COPPICE_CHECK(registry_.load("terrain"));
    COPPICE_TRY(TileForest tiles, load_forest(populated, registry_.find<TerrainInterface>(
                                                             k_terrain_interface, k_terrain_version)));
    scene_.name = tiles.name;
    scene_.path = tiles.path;
    scene_.models = tiles.models;
    scene_.light = tiles.light;
    scene_.camera_path = tiles.camera_path;
    scene_.sample_distance_px = tiles.sample_distance_px;
    COPPICE_TRY(std::vector<Plant> plants, load_plants(tiles));
    return vegetation_->set_world(std::move(tiles), std::move(plants),
                                  {settings.tile_memory_bytes, settings.tile_memory_bytes});
}

Status EmbeddedForest::record(const EmbeddedFrame& frame) {
    vegetation_->set_slot(frame.slot);
    COPPICE_CHECK(vegetation_->set_host_picture(frame.picture));
    vegetation_->set_camera(frame.camera);
    vegetation_->set_settings(frame.settings);
    schedule_.run();
    graph_.record(frame.commands, nullptr);
    return {};
}

}  // namespace coppice
