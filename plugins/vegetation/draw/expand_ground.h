// From the grounds in view to the work list: each patch of a terrain at the level its distance asks for.
#pragma once
#include "plugins/vegetation/cull/list_grounds.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/work_list.h"

namespace coppice {

// error_px: a level's error stays below it on the picture; 0: all at the finest. Returns the triangles.
uint64_t expand_grounds(std::span<const GroundInView> in_view, const SceneGeometry& geometry,
                        const Frustum& frustum, float error_px, WorkPart& work);

}  // namespace coppice
