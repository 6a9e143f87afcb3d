// From what is in view to the work list: decides each part's level and writes what is drawn.
#pragma once
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/see_plants.h"
#include "plugins/vegetation/draw/work_list.h"

namespace coppice {

// The plants seen of one run, into one part of the work list. Any thread. rest_index: RestingFrame::index, which points
// and lines. seen must stay as it is until the work list has been gathered: it holds the instances.
void draw_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                 uint32_t rest_index, WorkPart& work);

// What expand_clouds will draw.
void measure_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                    const FrameSettings& settings, BudgetHistogram& histogram);
// Tiles that their clouds stand for, into one part of the work list.
void expand_clouds(std::span<const CloudTile> tiles, const SceneGeometry& geometry, const Frustum& frustum,
                   const FrameSettings& settings, WorkPart& work);

// What the ground may be off by on the picture.
inline float ground_error_px(const FrameSettings& settings) { return settings.level_of_detail ? 1.0f : 0.0f; }

}  // namespace coppice
