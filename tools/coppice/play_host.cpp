#include "tools/coppice/play_host.h"

#include <algorithm>
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/plant_scene.h"
#include "plugins/vegetation/eco/read_light.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

Result<uint64_t> hash_file(const std::string& path) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    return hash_bytes(file.bytes().data(), file.bytes().size());
}

std::string cache_dir_of(const PlayOptions& options) {
    return options.cache_dir.empty() ? default_cache_dir() : options.cache_dir;
}

SceneLoadSettings scene_load_settings(PlayHost& host, const PlayOptions& options) {
    return {host.registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version),
            host.registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version),
            cache_dir_of(options),
            {},
            [&host] { return host.find_images(); },
            read_named_places};
}

}  // namespace

PlayHost::~PlayHost() = default;

Status PlayHost::load_plugins() {
    for (const char* name : k_player_plugins) COPPICE_CHECK(registry.load(name));
    return {};
}

const ImagesInterface* PlayHost::find_images() {
    if (!registry.load("images")) return nullptr;
    return registry.find<ImagesInterface>(k_images_interface, k_images_version);
}

// A plant's scene is made when its size is known, in load_plants.
Status PlayHost::load_scene_file(const PlayOptions& options) {
    if (!populated_scene_file(options.scene).empty()) return load_forest_file(options);
    Stopwatch clock;
    COPPICE_TRY(const uint64_t file_hash, hash_file(options.scene));
    hashes.emplace_back("scene file", file_hash);
    if (is_plant_file(options.scene)) {
        scene.models = {plant_scene_model(options.scene)};
    } else {
        COPPICE_TRY(scene, load_scene(options.scene, scene_load_settings(*this, options)));
    }
    if (!options.path.empty()) {
        COPPICE_TRY(scene.camera_path, load_camera_path(options.path, scene.terrain.get()));
    }
    load.scene_ms = clock.ms();
    return {};
}

Status PlayHost::load_forest_file(const PlayOptions& options) {
    Stopwatch clock;
    const std::string file = populated_scene_file(options.scene);
    if (options.keep_scene)
        return fail(ErrorId::usage, file, "", "a populated scene is never in memory as a whole",
                    "name the *.eco.json that it was made from");
    COPPICE_TRY(const uint64_t file_hash, hash_file(file));
    hashes.emplace_back("scene file", file_hash);
    COPPICE_TRY(forest_,
                load_forest(file, registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version)));
    scene.name = forest_->name;
    scene.path = forest_->path;
    scene.models = forest_->models;
    scene.camera_path = forest_->camera_path;
    scene.sample_distance_px = forest_->sample_distance_px;
    plant_count = forest_->rows.empty() ? 0 : forest_->rows.front().plant_count;
    if (!options.path.empty()) {
        COPPICE_TRY(scene.camera_path, load_camera_path(options.path, [this](double x, double z) {
                        return ground_height(*forest_, x, z);
                    }));
    }
    load.scene_ms = clock.ms();
    return {};
}

Result<std::vector<Plant>> PlayHost::load_forest_plants() {
    Stopwatch clock;
    COPPICE_TRY(std::vector<Plant> plants, coppice::load_plants(*forest_));
    for (size_t m = 0; m < plants.size(); ++m)
        hashes.emplace_back("plant " + scene.models[m].name, plants[m].content_hash);
    load.plants_ms = clock.ms();
    return plants;
}

Result<std::vector<Plant>> PlayHost::load_plants(const PlayOptions& options) {
    if (forest_) return load_forest_plants();
    Stopwatch plants_clock;
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    std::vector<PlantSource> sources;
    for (const SceneModel& model : scene.models) sources.push_back({model.source_path, model.variation});
    const bool textured = std::any_of(sources.begin(), sources.end(), [](const PlantSource& source) {
        return !source.path.ends_with(".json") && !source.path.ends_with(".plant");
    });
    COPPICE_TRY(std::vector<Plant> plants, find_or_cook(cache_dir_of(options), sources, CookSettings{},
                                                        modeller, textured ? find_images() : nullptr));
    load.plants_ms = plants_clock.ms();

    Stopwatch tiles_clock;
    std::vector<Box> bounds;
    for (size_t i = 0; i < plants.size(); ++i) {
        hashes.emplace_back("plant " + scene.models[i].name, plants[i].content_hash);
        bounds.push_back(plants[i].bounds_plant);
    }
    const auto* terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    if (is_plant_file(options.scene)) {
        std::vector<CameraKey> chosen_path = std::move(scene.camera_path);
        COPPICE_TRY(scene, make_plant_scene(options.scene, bounds.front(), options.height, terrain));
        if (!chosen_path.empty()) scene.camera_path = std::move(chosen_path);
    }
    if (options.keep_scene) {
        COPPICE_TRY(const Scene again,
                    is_plant_file(options.scene)
                        ? make_plant_scene(options.scene, bounds.front(), options.height, terrain)
                        : load_scene(options.scene, scene_load_settings(*this, options)));
        bare_terrain = again.terrain;
    }
    finish_tiles(scene, bounds);
    if (scene.terrain) shade_ground(scene, *scene.terrain, bounds);
    load.tiles_ms = tiles_clock.ms();
    return plants;
}

Status PlayHost::create_device(const PlayOptions& options,
                               const std::vector<const char*>& present_extensions) {
    Stopwatch clock;
    gpu::DeviceSettings settings;
    settings.choice = options.device;
    settings.validation = options.validation;
    settings.present = !present_extensions.empty();
    settings.instance_extensions = present_extensions;
    COPPICE_TRY(device, gpu::Device::create(settings));
    COPPICE_TRY(ring, gpu::CommandRing::create(*device, k_frame_slots));
    load.device_ms = clock.ms();
    return {};
}

Status PlayHost::create_vegetation(const PlayOptions& options, std::vector<Plant> loaded) {
    Stopwatch clock;
    const auto* interface = registry.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
    if (!interface)
        return fail(ErrorId::name_unknown, "", "plugin vegetation", "does not provide its interface",
                    "install the plugin of this version");
    VegetationSettings settings;
    settings.device = device.get();
    settings.world = &world;
    settings.schedule = &schedule;
    settings.frame_graph = &graph;
    settings.frame_slots = k_frame_slots;
    settings.width = width = options.width;
    settings.height = height = options.height;
    COPPICE_TRY(vegetation, interface->create(settings));
    if (forest_) {
        if (options.sun_deg)
            forest_->light.direction_to_sun = direction_to_sun(options.sun_deg->x, options.sun_deg->y);
        const uint64_t budget_bytes = uint64_t(options.tile_memory_mib) << 20;
        COPPICE_CHECK(
            vegetation->set_world(std::move(*forest_), std::move(loaded), {budget_bytes, budget_bytes}));
        forest_.reset();
    } else {
        COPPICE_CHECK(show_scene(options, std::move(loaded)));
    }
    load.upload_ms = clock.ms();
    return {};
}

Status PlayHost::show_scene(const PlayOptions& options, std::vector<Plant> loaded) {
    if (options.sun_deg)
        scene.light.direction_to_sun = direction_to_sun(options.sun_deg->x, options.sun_deg->y);
    if (options.keep_scene) plants = loaded;
    COPPICE_CHECK(vegetation->set_scene(scene, std::move(loaded)));
    // The world has its own: 32 bytes a plant need not be kept twice.
    plant_count = scene.positions.size();
    if (!options.keep_scene) {
        scene.positions = {};
        scene.turns = {};
        scene.plant_models = {};
        scene.tiles = {};
    }
    return {};
}

Status PlayHost::reload(const PlayOptions& options) {
    Scene shown = std::exchange(scene, {});
    std::vector<std::pair<std::string, uint64_t>> shown_hashes = std::exchange(hashes, {});
    const Status loaded = [&]() -> Status {
        COPPICE_CHECK(load_scene_file(options));
        COPPICE_TRY(std::vector<Plant> again, load_plants(options));
        return show_scene(options, std::move(again));
    }();
    if (!loaded) {
        scene = std::move(shown);
        hashes = std::move(shown_hashes);
    }
    return loaded;
}

Result<std::unique_ptr<PlayHost>> PlayHost::create(const PlayOptions& options,
                                                   const std::vector<const char*>& present_extensions) {
    std::unique_ptr<PlayHost> host(new PlayHost);
    COPPICE_CHECK(host->load_plugins());
    COPPICE_CHECK(host->load_scene_file(options));
    COPPICE_CHECK(host->create_device(options, present_extensions));
    COPPICE_TRY(std::vector<Plant> plants, host->load_plants(options));
    COPPICE_CHECK(host->create_vegetation(options, std::move(plants)));
    return host;
}

Result<PlayHost::Frame> PlayHost::begin_frame(const Camera& camera, const FrameSettings& settings) {
    COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
    if (read_times) read_times(frame.slot, frame.timestamps->sections());
    // Nothing overlapped; draw_frame knows better.
    if (const double device_ms = frame.timestamps->total_ms(); device_ms > 0.0)
        vegetation->set_frame_ms(frame.slot, device_ms + schedule_ms_of_slot_[frame.slot]);
    vegetation->set_slot(frame.slot);
    vegetation->set_camera(camera);
    vegetation->set_settings(settings);
    Stopwatch clock;
    schedule.run();
    const double schedule_ms = schedule_ms_of_slot_[frame.slot] = clock.ms();
    graph.record(frame.commands, frame.timestamps);
    return Frame{frame, schedule_ms};
}

Result<PlayHost::FrameTimes> PlayHost::draw_frame(const Camera& camera, const FrameSettings& settings) {
    Stopwatch clock;
    COPPICE_TRY(const Frame frame, begin_frame(camera, settings));
    COPPICE_CHECK(ring.submit());
    const double cpu_ms = clock.ms();
    COPPICE_CHECK(ring.wait(frame.ring.serial));
    const double wall_ms = clock.ms();
    vegetation->set_frame_ms(frame.ring.slot, wall_ms);
    return FrameTimes{wall_ms, frame.schedule_ms, cpu_ms, frame.ring.slot};
}

Status PlayHost::finish_times() {
    for (uint32_t i = 0; i < ring.slots(); ++i) {
        COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
        if (read_times) read_times(frame.slot, frame.timestamps->sections());
        COPPICE_CHECK(ring.submit());
        COPPICE_CHECK(ring.wait(frame.serial));
    }
    return {};
}

Result<Picture> PlayHost::read_picture() const {
    Picture picture{width, height, std::vector<uint8_t>(size_t(width) * height * 4)};
    COPPICE_CHECK(
        gpu::read_now(*device, vegetation->color(), 0, std::as_writable_bytes(std::span(picture.rgba))));
    return picture;
}

Status PlayHost::resize(uint32_t width_px, uint32_t height_px) {
    COPPICE_CHECK(vegetation->resize(width_px, height_px));
    width = width_px;
    height = height_px;
    return {};
}

}  // namespace coppice
