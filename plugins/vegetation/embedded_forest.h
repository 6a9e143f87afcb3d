// A forest in a host's own Vulkan program: all that stands between a scene's file and commands in the host's command buffer,
// for hosts that have no world, schedule or frame graph of this runtime. A frame of the host:
//
//     ... draw the own geometry into colour and depth, end the render pass
//     forest->record({commands, slot, camera, settings, picture});
//     ... whatever follows, and submit
//
// Nothing is submitted, waited for or presented. One thread at a time. docs/embedding.md says how to begin.
#pragma once
#include <memory>
#include <string>
#include "plugins/vegetation/load_planted_scene.h"
#include "plugins/vegetation/loose_plants.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/core/watched_files.h"

namespace coppice {

struct EmbeddedForestSettings {
    gpu::HostDevice device;                            // without a queue: see runtime/gpu/device.h
    std::string scene;                                 // *.eco.json, a plant, or a populated folder
    std::string cache_dir;                             // of cooked plants; empty: default_cache_dir()
    uint32_t width = 1280, height = 720;               // of the host's picture
    uint32_t frame_slots = 2;                          // frames in flight
    uint64_t tile_memory_bytes = uint64_t(256) << 20;  // of a populated folder
    uint32_t loose_tiles = 1024;                       // squares of 16 m that plants() may stand in
};

struct EmbeddedFrame {
    VkCommandBuffer commands;  // recording, outside of a render pass
    uint32_t slot;             // below frame_slots; the device has finished its last frame
    Camera camera;
    FrameSettings settings;
    HostPicture picture;  // without colour: the whole picture is left in vegetation().color()
};

class EmbeddedForest {
  public:
    // Errors: device_missing (what the device lacks), those of loading, limit_exceeded, device_lost.
    static Result<std::unique_ptr<EmbeddedForest>> create(const EmbeddedForestSettings& settings);
    // The device has finished all frames that were recorded.
    ~EmbeddedForest();

    // Errors: LoosePlants::show's, Vegetation::set_host_picture's; nothing is recorded then.
    Status record(const EmbeddedFrame& frame);
    // Of the host's picture from the next frame on.
    Status resize(uint32_t width, uint32_t height) { return vegetation_->resize(width, height); }

    Vegetation& vegetation() { return *vegetation_; }
    const FrameReport& report() const { return vegetation_->report(); }
    // Plants of the host's own, beside the scene's; a populated folder takes none. What changed is drawn by the next record.
    LoosePlants& plants() { return *loose_; }
    // Stems of the scene's plants, numbered as the rows of scene(), and of plants(); of a populated folder of none. Any number
    // of threads while nobody changes plants().
    const StemIndex& stems() const { return stems_; }

    // Loads the scene again, if a file that it came from has changed, and draws it from the next record on: true. Takes as
    // long as loading does. On an error the old one stays, and so it is until a file changes again. plants() keep their
    // numbers; those whose models are gone are removed, with a warning. Errors: those of loading; usage (a populated folder).
    Result<bool> reload_if_changed();

    // As loaded: its light and flight, and where its plants stand, but for a populated folder.
    const Scene& scene() const { return scene_; }

  private:
    EmbeddedForest() = default;
    Status load(const EmbeddedForestSettings& settings);
    Status load_populated(const EmbeddedForestSettings& settings, const std::string& file);
    Status show_scene(PlantedScene planted, std::vector<LooseModel>& models);
    Result<PlantedScene> read_scene();

    // In the order of what needs what, destroyed from the last to the first.
    Registry registry_;
    Scene scene_;
    std::unique_ptr<gpu::Device> device_;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;
    std::unique_ptr<Vegetation> vegetation_;
    StemIndex stems_;
    std::unique_ptr<LoosePlants> loose_;
    WatchedFiles files_;
    std::string scene_file_, cache_dir_;
};

}  // namespace coppice
