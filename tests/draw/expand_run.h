// Plants of one run, seen and drawn into a work list in one go, with what is behind the ground.
#pragma once
#include "plugins/vegetation/draw/expand_plants.h"

namespace coppice {

struct ExpandCounts {
    uint32_t plants_visible = 0;
    uint64_t full_triangles = 0;
};

// seen: until work has been gathered.
inline ExpandCounts expand_run(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                               const FrameSettings& settings, uint32_t rest_index, SeenPlants& seen,
                               WorkPart& work) {
    see_plants(run, geometry, frustum, nullptr, 0.0f, seen);
    draw_plants(seen, geometry, settings, rest_index, work);
    return {seen.plant_count, seen.full_triangles};
}

}  // namespace coppice
