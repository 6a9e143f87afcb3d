// From the plants in view to the work list: culls each, decides its parts' levels and writes what is drawn.
#pragma once
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/work_list.h"

namespace coppice {

struct ExpandCounts {
    uint32_t plants_visible = 0;
    uint64_t full_triangles = 0;
};

// One run, into one part of the work list. Any thread. rest_index: RestingFrame::index, which points and lines.
ExpandCounts expand_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                           const FrameSettings& settings, uint32_t rest_index, WorkPart& work);

// Tiles that their clouds stand for, into one part of the work list.
void expand_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                   const FrameSettings& settings, uint32_t rest_index, WorkPart& work);

}  // namespace coppice
