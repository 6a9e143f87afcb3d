#include "tools/coppice/play_host.h"

#include <algorithm>

#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/mapped_file.h"
#include "runtime/core/progress.h"

namespace coppice {
namespace {

constexpr uint32_t k_frame_slots = 2;

Result<uint64_t> hash_file(const std::string& path) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    return hash_bytes(file.bytes().data(), file.bytes().size());
}

}  // namespace

PlayHost::~PlayHost() = default;

Status PlayHost::load_plugins() {
    for (const char* name : {"terrain", "modeller", "vegetation"}) COPPICE_CHECK(registry.load(name));
    return {};
}

const ImagesInterface* PlayHost::find_images() {
    if (!registry.load("images")) return nullptr;
    return registry.find<ImagesInterface>(k_images_interface, k_images_version);
}

// Cooks what is missing, all models side by side, and maps every plant.
Result<std::vector<Plant>> PlayHost::load_plants(const PlayOptions& options) {
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    const std::string cache_dir = options.cache_dir.empty() ? default_cache_dir() : options.cache_dir;
    const size_t count = scene.models.size();
    const bool textured = std::any_of(scene.models.begin(), scene.models.end(), [](const SceneModel& model) {
        return !model.source_path.ends_with(".json");
    });
    const ImagesInterface* images = textured ? find_images() : nullptr;
    std::vector<Result<std::string>> paths(count);
    Stopwatch cook_clock;
    {
        Progress progress("cooking plants", count);
        parallel_for(count, 1, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                const SceneModel& model = scene.models[i];
                paths[i] = find_or_cook(cache_dir, model.source_path, model.variation, CookSettings{},
                                        modeller, images);
                progress.advance();
            }
        });
    }
    load.cook_ms = cook_clock.ms();

    Stopwatch plants_clock;
    std::vector<Plant> plants;
    plants.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        COPPICE_TRY(const std::string path, std::move(paths[i]));
        COPPICE_TRY(Plant plant, load_plant(path));
        hashes.emplace_back("plant " + scene.models[i].name, plant.content_hash);
        plants.push_back(std::move(plant));
    }
    std::vector<Box> bounds;
    for (const Plant& plant : plants) bounds.push_back(plant.bounds_plant);
    finish_tiles(scene, bounds);
    if (scene.terrain) shade_ground(scene, *scene.terrain, bounds);
    load.plants_ms = plants_clock.ms();
    return plants;
}

Result<std::unique_ptr<PlayHost>> PlayHost::create(const PlayOptions& options,
                                                   const std::vector<const char*>& present_extensions) {
    std::unique_ptr<PlayHost> host(new PlayHost);
    COPPICE_CHECK(host->load_plugins());
    Stopwatch scene_clock;
    const auto* terrain = host->registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    COPPICE_TRY(host->scene, load_scene(options.scene, {terrain}));
    if (!options.path.empty()) {
        COPPICE_TRY(host->scene.camera_path, load_camera_path(options.path, host->scene.terrain.get()));
    }
    COPPICE_TRY(const uint64_t scene_hash, hash_file(options.scene));
    host->hashes.emplace_back("scene file", scene_hash);
    host->load.scene_ms = scene_clock.ms();
    COPPICE_TRY(std::vector<Plant> plants, host->load_plants(options));

    Stopwatch device_clock;
    gpu::DeviceSettings device_settings;
    device_settings.choice = options.device;
    device_settings.validation = options.validation;
    device_settings.present = !present_extensions.empty();
    device_settings.instance_extensions = present_extensions;
    COPPICE_TRY(host->device, gpu::Device::create(device_settings));
    COPPICE_TRY(host->ring, gpu::CommandRing::create(*host->device, k_frame_slots));
    host->load.device_ms = device_clock.ms();

    Stopwatch upload_clock;
    const auto* vegetation =
        host->registry.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
    if (!vegetation)
        return fail(ErrorId::name_unknown, "", "plugin vegetation", "does not provide its interface",
                    "install the plugin of this version");
    VegetationSettings settings;
    settings.device = host->device.get();
    settings.world = &host->world;
    settings.schedule = &host->schedule;
    settings.frame_graph = &host->graph;
    settings.frame_slots = k_frame_slots;
    settings.width = host->width = options.width;
    settings.height = host->height = options.height;
    COPPICE_TRY(host->vegetation, vegetation->create(settings));
    COPPICE_CHECK(host->vegetation->set_scene(host->scene, std::move(plants)));
    host->load.upload_ms = upload_clock.ms();
    return host;
}

Result<PlayHost::Frame> PlayHost::begin_frame(const Camera& camera, const FrameSettings& settings) {
    COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
    if (read_times) read_times(frame.slot, frame.timestamps->sections());
    vegetation->set_slot(frame.slot);
    vegetation->set_camera(camera);
    vegetation->set_settings(settings);
    Stopwatch clock;
    schedule.run();
    const double schedule_ms = clock.ms();
    graph.record(frame.commands, frame.timestamps);
    return Frame{frame, schedule_ms};
}

Result<PlayHost::FrameTimes> PlayHost::draw_frame(const Camera& camera, const FrameSettings& settings) {
    Stopwatch clock;
    COPPICE_TRY(const Frame frame, begin_frame(camera, settings));
    COPPICE_CHECK(ring.submit());
    COPPICE_CHECK(ring.wait(frame.ring.serial));
    return FrameTimes{clock.ms(), frame.schedule_ms, frame.ring.slot};
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
