// From the grounds in view to the work list: each patch of a terrain at the level its distance asks for.
#pragma once
#include "plugins/vegetation/cull/list_grounds.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/work_list.h"

namespace coppice {

class GroundExpander {
  public:
    // error_px: a level's error stays below it on the picture; 0: all at the finest. Returns the triangles. Allocates for a
    // terrain larger than those before. least_slope: ground that is nowhere that steep, in m a metre, is left out.
    uint64_t expand(std::span<const GroundInView> in_view, const SceneGeometry& geometry,
                    const Frustum& frustum, float error_px, WorkPart& work, float least_slope = 0.0f);

  private:
    uint64_t expand_terrain(const Terrain& terrain, vec3 origin_camera, uint32_t first_vertex,
                            const Frustum& frustum, float error_px, WorkPart& work, float least_slope);
    uint64_t expand_skirts(const Terrain& terrain, size_t patch, uint32_t first_vertex, uint32_t instance,
                           WorkPart& work) const;
    std::vector<uint32_t> level_of_patch_;
};

}  // namespace coppice
