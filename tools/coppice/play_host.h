// What any program has that embeds the vegetation plugin: plugins, a scene with its plants, a device, a
// world, a schedule, a frame graph and a ring of command buffers. One thread at a time.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/ecs/schedule.h"
#include "runtime/ecs/world.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/commands.h"
#include "runtime/gpu/device.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/play_options.h"
#include "tools/coppice/play_record.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {

// Without these nothing is drawn. What only a window or other formats need is loaded where it is met.
inline constexpr const char* k_player_plugins[] = {"terrain", "modeller", "vegetation"};

class PlayHost {
  public:
    // Loads everything the options name: a scene, or a plant with a scene made for it. The device comes
    // before the plants, so that whoever has none need not wait for those that are not in the cache.
    // present_extensions: of the instance, where the pictures go to a window.
    static Result<std::unique_ptr<PlayHost>> create(const PlayOptions& options,
                                                    const std::vector<const char*>& present_extensions = {});
    ~PlayHost();

    // Called with the device times of the frame that used a slot last, before the slot is used again.
    using ReadTimes = std::function<void(uint32_t slot, std::span<const gpu::Timestamps::Section> sections)>;
    ReadTimes read_times;

    // Runs the systems and records the passes. The caller submits: with the ring, or with a window.
    struct Frame {
        gpu::CommandRing::Frame ring;
        double schedule_ms;  // CPU: the systems
    };
    Result<Frame> begin_frame(const Camera& camera, const FrameSettings& settings);

    // One frame, from its start until its picture is complete.
    struct FrameTimes {
        double wall_ms, schedule_ms;
        double cpu_ms;  // until it was submitted
        uint32_t slot;
    };
    Result<FrameTimes> draw_frame(const Camera& camera, const FrameSettings& settings);
    // Calls read_times for the frames that have not been asked for yet.
    Status finish_times();
    // Of the last frame drawn.
    Result<Picture> read_picture() const;
    Status resize(uint32_t width_px, uint32_t height_px);
    // Loads what the options name again, and draws it from the next frame on. On an error what was drawn stays. Not of a
    // populated folder.
    Status reload(const PlayOptions& options);
    // Loaded when first asked for, because it brings a hundred libraries along. nullptr where it is not
    // installed.
    const ImagesInterface* find_images();

    // In the order of what needs what, destroyed from the last to the first.
    Registry registry;
    Scene scene;                // without its plants once they are in the world, unless options.keep_scene
    std::vector<Plant> plants;  // plants[i] is scene.models[i]; only with keep_scene
    std::shared_ptr<Terrain> bare_terrain;  // before plants darkened it; only with keep_scene
    uint64_t plant_count = 0;
    std::vector<std::pair<std::string, uint64_t>> hashes;  // of what was loaded
    LoadTimes load{};
    std::unique_ptr<gpu::Device> device;
    World world;
    Schedule schedule{world};
    FrameGraph graph;
    std::unique_ptr<Vegetation> vegetation;
    gpu::CommandRing ring;
    uint32_t width = 0, height = 0;

  private:
    std::optional<TileForest> forest_;  // of a populated scene, until the vegetation has it
    static constexpr uint32_t k_frame_slots = 2;
    std::array<double, k_frame_slots> schedule_ms_of_slot_{};
    PlayHost() = default;
    Status load_plugins();
    Status load_scene_file(const PlayOptions& options);
    Status load_forest_file(const PlayOptions& options);
    Result<std::vector<Plant>> load_forest_plants();
    Result<std::vector<Plant>> load_plants(const PlayOptions& options);
    Status create_device(const PlayOptions& options, const std::vector<const char*>& present_extensions);
    Status create_vegetation(const PlayOptions& options, std::vector<Plant> loaded);
    Status show_scene(const PlayOptions& options, std::vector<Plant> loaded);
};

}  // namespace coppice
