#include "plugins/vegetation/embedded_forest.h"

#include <algorithm>
#include "plugins/vegetation/eco/populated_scene.h"
#include "runtime/core/log.h"

namespace coppice {
namespace {

std::vector<LooseModel> describe_models(const Scene& scene, std::span<const Plant> plants) {
    std::vector<LooseModel> models;
    for (size_t m = 0; m < plants.size(); ++m)
        models.push_back({scene.models[m].name, plants[m].bounds_plant, measure_stem(plants[m])});
    return models;
}

}  // namespace

EmbeddedForest::~EmbeddedForest() = default;

Result<std::unique_ptr<EmbeddedForest>> EmbeddedForest::create(const EmbeddedForestSettings& settings) {
    std::unique_ptr<EmbeddedForest> forest(new EmbeddedForest);
    COPPICE_TRY(forest->device_, gpu::Device::adopt(settings.device));
    VegetationSettings of{forest->device_.get(), &forest->world_, &forest->schedule_, &forest->graph_,
                          settings.frame_slots,  settings.width,  settings.height};
    of.loose_tiles = settings.loose_tiles;
    COPPICE_TRY(forest->vegetation_, create_vegetation(of));
    COPPICE_CHECK(forest->load(settings));
    return forest;
}

Status EmbeddedForest::load(const EmbeddedForestSettings& settings) {
    scene_file_ = settings.scene;
    cache_dir_ = settings.cache_dir;
    if (const std::string populated = populated_scene_file(settings.scene); !populated.empty())
        return load_populated(settings, populated);
    COPPICE_TRY(PlantedScene planted, read_scene());
    std::vector<LooseModel> models;
    COPPICE_CHECK(show_scene(std::move(planted), models));
    loose_ = std::make_unique<LoosePlants>(*vegetation_, stems_, std::move(models),
                                           std::min(settings.loose_tiles, k_loose_tile_limit));
    return {};
}

Status EmbeddedForest::load_populated(const EmbeddedForestSettings& settings, const std::string& file) {
    COPPICE_CHECK(registry_.load("terrain"));
    COPPICE_TRY(TileForest tiles,
                load_forest(file, registry_.find<TerrainInterface>(k_terrain_interface, k_terrain_version)));
    scene_.name = tiles.name;
    scene_.path = tiles.path;
    scene_.models = tiles.models;
    scene_.light = tiles.light;
    scene_.camera_path = tiles.camera_path;
    scene_.sample_distance_px = tiles.sample_distance_px;
    COPPICE_TRY(std::vector<Plant> plants, load_plants(tiles));
    loose_ = std::make_unique<LoosePlants>(*vegetation_, stems_, describe_models(scene_, plants), 0);
    return vegetation_->set_world(std::move(tiles), std::move(plants),
                                  {settings.tile_memory_bytes, settings.tile_memory_bytes});
}

Result<PlantedScene> EmbeddedForest::read_scene() {
    files_.begin();
    Result<PlantedScene> planted = load_planted_scene(scene_file_, registry_, cache_dir_);
    files_.end();
    return planted;
}

// models: of the scene, when it is shown.
Status EmbeddedForest::show_scene(PlantedScene planted, std::vector<LooseModel>& models) {
    models = describe_models(planted.scene, planted.plants);
    COPPICE_CHECK(vegetation_->set_scene(planted.scene, std::move(planted.plants)));
    scene_ = std::move(planted.scene);
    std::vector<StemShape> shapes;
    for (const LooseModel& model : models) shapes.push_back(model.stem);
    stems_ = StemIndex(stems_of(scene_, shapes));
    return {};
}

Result<bool> EmbeddedForest::reload_if_changed() {
    if (!populated_scene_file(scene_file_).empty())
        return fail(ErrorId::usage, scene_file_, "",
                    "a populated folder is not loaded again while it is drawn",
                    "name the *.eco.json that it was made from");
    if (!files_.changed()) return false;
    COPPICE_TRY(PlantedScene planted, read_scene());
    std::vector<LooseModel> models;
    COPPICE_CHECK(show_scene(std::move(planted), models));
    if (const size_t removed = loose_->change_models(std::move(models)))
        log_warning("{}: {} plants of the host are gone with their models", scene_.path, removed);
    return true;
}

Status EmbeddedForest::record(const EmbeddedFrame& frame) {
    vegetation_->set_slot(frame.slot);
    COPPICE_CHECK(loose_->show());
    COPPICE_CHECK(vegetation_->set_host_picture(frame.picture));
    vegetation_->set_camera(frame.camera);
    vegetation_->set_settings(frame.settings);
    schedule_.run();
    graph_.record(frame.commands, nullptr);
    return {};
}

}  // namespace coppice
