// What a host calls. Interface "coppice.vegetation": makes a Vegetation, which registers its systems in the host's
// schedule and its passes in the host's frame graph. A frame of the host:
//
//     vegetation->set_camera(camera);  vegetation->set_settings(settings);
//     schedule.run();                               // of ours: stream, cull, lod, draw, report
//     frame_graph.record(frame.commands, frame.timestamps);
//     ... submit; vegetation->color() then holds the picture, or the host's own picture has plants in it
//
// The command buffer is any that records on the device's queue family, outside of a render pass; nothing is submitted,
// waited for or presented by a frame. embedded_forest.h has all of this in one object; docs/embedding.md says how to begin.
//
// One thread at a time; inside, the jobs of runtime/core/jobs.h. Systems and passes refer to the Vegetation: run
// neither the schedule nor the frame graph after it is gone, record the frame graph after each run of the schedule, and
// destroy all three before the world, and that before the registry that loaded the plugin. Its destructor waits for the
// device.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/draw/host_picture.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/eco/stream_tiles.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "plugins/vegetation/lod/settings.h"
#include "plugins/vegetation/plant/plant.h"
#include "plugins/vegetation/report/explanation.h"
#include "plugins/vegetation/report/report.h"
#include "runtime/ecs/schedule.h"
#include "runtime/ecs/world.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/device.h"

namespace coppice {

struct VegetationSettings {
    const gpu::Device* device = nullptr;
    World* world = nullptr;
    Schedule* schedule = nullptr;
    FrameGraph* frame_graph = nullptr;
    uint32_t frame_slots = 2;  // frames in flight: rings are this long
    uint32_t width = 1280, height = 720;
    uint32_t loose_tiles = 0;  // that set_loose_tile may be given, at most k_loose_tile_limit
};

inline constexpr uint32_t k_loose_tile_limit = 1u << 20;

// Some plants of a host that changes them while they are drawn; spans of one length. The plants' models are the scene's.
struct LooseTile {
    Tile tile;  // bounds as of other tiles: of all its plants at full size
    std::span<const PlantPosition> positions;
    std::span<const PlantTurn> turns;
    std::span<const PlantModel> models;
};

class Vegetation {
  public:
    virtual ~Vegetation() = default;

    // plants[i] is the packed plant of scene.models[i]. Uploads geometry, makes the tiles' chunks. Replaces the scene
    // before, beside which it has to have room: where it has not, set an empty one first. Waits for the device; not for frames.
    // Errors: value_out_of_range, limit_exceeded, device_lost; the old scene stays.
    virtual Status set_scene(const Scene& scene, std::vector<Plant> plants) = 0;
    // A world that is read while it is flown over (eco/tile_forest.h). plants[i] is the packed plant of forest.models[i].
    // Errors: set_scene's.
    virtual Status set_world(TileForest forest, std::vector<Plant> plants,
                             const ResidencySettings& settings) = 0;
    // Beside the scene's tiles, in place of what was given under this name before; without plants: no more. Drawn plant by
    // plant, since nothing stands for them in the distance: for what is being edited, not for millions. From the next
    // schedule on, between frames; waits for nothing. set_scene takes them all away, and set_world has none. Errors:
    // value_out_of_range (a model the scene lacks, spans of different length), limit_exceeded; the old tile stays then.
    virtual Status set_loose_tile(uint64_t name, const LooseTile& tile) = 0;
    // Size of the picture; waits for the device. 1 to 16384 a side. On an error the old size stays.
    virtual Status resize(uint32_t width, uint32_t height) = 0;

    virtual void set_camera(const Camera& camera) = 0;
    virtual void set_light(const Light& light) = 0;
    virtual void set_settings(const FrameSettings& settings) = 0;
    // Which of the rings the next frame uses; CommandRing::Frame::slot. The device has finished the slot's last frame: what
    // only that one used is destroyed.
    virtual void set_slot(uint32_t slot) = 0;
    // What the next frames are drawn into, by depth, in place of color(); one without colour: color() again. As large as the
    // vegetation's picture: after a resize it must be set again. A view at rest keeps no mean then. Errors:
    // HostComposite::prepare's, limit_exceeded, device_lost; on an error frames go to color().
    virtual Status set_host_picture(const HostPicture& picture) = 0;
    // How long the frame took that used the slot last: what FrameSettings::time_budget_ms is to hold, be it the device's
    // time or all. Before the slot's next frame; a frame whose time is not told teaches nothing.
    virtual void set_frame_ms(uint32_t slot, double ms) = 0;

    // RGBA8, sRGB-encoded, width * height, rows from the top; written by the pass "resolve".
    virtual const gpu::Buffer& color() const = 0;
    virtual ResourceIndex color_resource() const = 0;
    // Depth and surface words of the last frame, for tests: width * height 64-bit words (DESIGN 4).
    virtual const gpu::Buffer& visibility() const = 0;
    // Counts of the frame whose schedule ran last.
    virtual const FrameReport& report() const = 0;
    // What that frame drew, at which level, and why; its sums are the report's. Looks at all it drew once more: for people who
    // ask, not for every frame. Empty before the first frame of a scene.
    virtual FrameExplanation explain_frame() const = 0;
};

inline constexpr const char* k_vegetation_interface = "coppice.vegetation";
inline constexpr uint32_t k_vegetation_version = 5;

// For programs that link coppice::vegetation; others have it from the plugin, by name. Requires all four of the settings.
// Errors: limit_exceeded, device_lost.
Result<std::unique_ptr<Vegetation>> create_vegetation(const VegetationSettings& settings);

struct VegetationInterface {
    uint32_t size_bytes;
    Result<std::unique_ptr<Vegetation>> (*create)(const VegetationSettings& settings);
};

}  // namespace coppice
