// Interface "coppice.reference": the picture a scene should have, traced ray by ray with every triangle. Shares the
// packed plants with the rasteriser and no code, so that neither can hide the other's faults. A module, because the
// ray tracer is large and only measurements need it.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/picture.h"

namespace coppice {

struct ReferenceSettings {
    uint32_t width = 795, height = 700;  // 1 to k_picture_side_limit
    // Stratified over the pixel: rounded up to the next square number. At least 64 for what is called a reference.
    uint32_t samples_per_pixel = 64;
    bool show_progress = false;
};

// The same rays lit in two ways. All have width * height pixels, rows from the top; no value is NaN.
struct ReferencePicture {
    uint32_t samples_per_pixel = 0;
    // Linear radiance, before exposure and tone curve, mean over the pixel. The sun's light is cut off by shadow rays;
    // the ground has its own colours. The truth.
    FloatPicture shadowed;
    // With what stands in for shadows while frames are drawn: openness and the ground's darkened colours
    // (draw/light.glsl, eco/shade_ground.h). A frame that differs from this one differs by its level of detail.
    FloatPicture unshadowed;
    // Shares of the pixel: r shows a plant, g the ground, b the sky.
    FloatPicture coverage;
};

// A scene with all its triangles, ready for rays. Any number of traces, one at a time; uses all threads.
class RayScene {
  public:
    virtual ~RayScene() = default;
    // Same scene, camera and settings, same bytes, on any number of threads.
    virtual Result<ReferencePicture> trace(const Camera& camera, const ReferenceSettings& settings) const = 0;
    virtual uint64_t triangle_count() const = 0;  // of all instances, and the ground's
};

inline constexpr const char* k_reference_interface = "coppice.reference";
inline constexpr uint32_t k_reference_version = 1;

struct ReferenceInterface {
    uint32_t size_bytes;
    // plants[i] belongs to scene.models[i]. bare_terrain: the scene's terrain before shade_ground darkened it; null
    // where the scene has none. Everything is copied. Errors: value_out_of_range, limit_exceeded.
    Result<std::unique_ptr<RayScene>> (*create)(const Scene& scene, std::span<const Plant> plants,
                                                const Terrain* bare_terrain);
};

}  // namespace coppice
