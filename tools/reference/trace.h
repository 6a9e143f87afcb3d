// Pictures of a RayGeometry, sample by sample.
#pragma once
#include "tools/reference/ray_scene.h"
#include "tools/reference/reference.h"

namespace coppice {

// Errors: value_out_of_range, limit_exceeded.
Result<ReferencePicture> trace(const RayGeometry& geometry, const Camera& camera,
                               const ReferenceSettings& settings);

// What the module's interface provides.
Result<std::unique_ptr<RayScene>> create_ray_scene(const Scene& scene, std::span<const Plant> plants,
                                                   const Terrain* bare_terrain);

}  // namespace coppice
