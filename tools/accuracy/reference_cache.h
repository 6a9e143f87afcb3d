// References take minutes, so they are kept: as float EXR, named after everything that decides them.
#pragma once
#include <memory>
#include <span>
#include <string>
#include "plugins/images/images.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"
#include "tools/reference/reference.h"

namespace coppice {

// One scene's references. Everything given here outlives it, unchanged.
struct ReferenceSource {
    const Scene* scene;
    std::span<const Plant> plants;
    const Terrain* bare_terrain;  // before shade_ground; null where there is none
    const ReferenceInterface* tracer;
    const ImagesInterface* images;
    std::string cache_dir;
};

class ReferenceCache {
  public:
    explicit ReferenceCache(const ReferenceSource& source);
    // From the cache, or traced into it. What is found is used only if its bytes are those that were written, and its
    // size is right: anything else is traced again, with a note. Where the cache cannot be written the picture is
    // returned all the same, with a warning. Errors: of the tracer.
    Result<ReferencePicture> find_or_trace(const Camera& camera, const ReferenceSettings& settings);
    uint32_t traced_count() const { return traced_count_; }

  private:
    ReferenceSource source_;
    uint64_t scene_hash_;
    std::unique_ptr<RayScene> rays_;  // made when first needed
    uint32_t traced_count_ = 0;
};

// Names a scene as drawn: plants, placements, ground, light. Places of files and names do not count.
uint64_t hash_scene(const Scene& scene, std::span<const Plant> plants, const Terrain* bare_terrain);

}  // namespace coppice
