// One plant twice, by the renderer that games have: to the left all its triangles, to the right what stands for it at some size
// in the picture, magnified to the size it is shown at.
#pragma once
#include <map>
#include <memory>
#include "plugins/vegetation/report/explanation.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/commands.h"
#include "runtime/plugin/registry.h"

namespace coppice {

// Where the viewer is, about the middle between the two.
struct StageView {
    float yaw_rad = 0.6f, pitch_rad = -0.12f;
    float zoom = 1.0f;       // 1: both fill the middle of the window
    float height_px = 200.0f;  // at which the plant's level of detail is shown
    bool own_size = false;   // it is shown at that size
    bool kinds = false;      // colours by kind of primitive
    bool shadows = false;
};

class PlantStage {
  public:
    static Result<std::unique_ptr<PlantStage>> create(const gpu::Device& device, Registry& registry, uint32_t width,
                                                      uint32_t height);
    // importance: of some parts by their index, in place of the plant's, until it has been cooked with it.
    Status show(const Plant& plant, const std::map<uint32_t, float>& importance = {});
    bool is_empty() const { return !(size_m_.y > 0.0f); }
    Status resize(uint32_t width, uint32_t height);

    // Records the passes; the caller submits. The plants stand in the middle of the columns [free_low_px, free_high_px).
    Result<gpu::CommandRing::Frame> begin_frame(gpu::CommandRing& ring, const StageView& view, float free_low_px,
                                                float free_high_px);
    const Vegetation& vegetation() const { return *vegetation_; }
    // How tall the plant was shown, and its d'.
    float shown_px() const { return shown_px_; }
    float sample_distance_px() const { return settings_.sample_distance_px; }
    // What stands for it, of the last frame.
    PrimitiveCounts drawn() const;

  private:
    PlantStage() = default;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;
    std::unique_ptr<Vegetation> vegetation_;
    Box bounds_m_;
    vec3 center_m_{0.0f}, size_m_{0.0f};
    FrameSettings settings_;
    float shown_px_ = 0.0f;
    uint32_t width_ = 0, height_ = 0;
};

}  // namespace coppice
