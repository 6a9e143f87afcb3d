// From what is in view to the work list: decides each part's level and writes what is drawn.
#pragma once
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/see_plants.h"
#include "plugins/vegetation/draw/work_list.h"
#include "plugins/vegetation/eco/part_chance.h"

namespace coppice {

// What a resting frame adds to all chances: multiples of the golden section.
inline float rest_turn(uint32_t rest_index) { return float(uint32_t(rest_index * 2654435769u) >> 8) * 0x1p-24f; }

// In [0, 1), moved on by turn: rounds fractions of a plant's primitives.
inline float turned_chance(uint32_t seed, uint32_t part_of_model, float turn) {
    const float chance = part_chance(seed, part_of_model) + turn;
    return chance < 1.0f ? chance : chance - 1.0f;
}

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
