// What is in view of a run of plants: culled and projected once, whatever d'. A budget measures it, perhaps several
// times, and then it is drawn; both go over it by each_part, so that what is drawn is what was measured.
#pragma once
#include "plugins/vegetation/cull/horizon.h"
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/work_list.h"
#include "plugins/vegetation/lod/budget.h"

namespace coppice {

// A part in one piece, or an octree cell of one that is near.
struct SeenPart {
    uint32_t part;  // of the scene's geometry
    PartProjection projected;
};

struct SeenPlant {
    WorkInstance instance;
    PlantView view;
    uint32_t first_part_of_model;
    PlantModel model;
    uint32_t part_end;  // its parts end here, and begin where those of the plant before end
};

// Kept from frame to frame, so that a warm frame allocates nothing.
struct SeenPlants {
    std::vector<SeenPlant> plants;
    std::vector<SeenPart> parts;
    uint32_t hidden_plants = 0;   // in view, but behind the ground
    uint64_t full_triangles = 0;  // had all been drawn
};

// Any thread. horizon: for runs that may have plants behind it (PlantRun::may_be_hidden); nullptr: nothing is hidden.
// spread_px: widest_spread_px.
void see_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                const FrameSettings& settings, const Horizon* horizon, float spread_px, SeenPlants& seen);

// Calls visit(plant, part, projected) for all that is drawn at the settings' d': cells in place of a part whose own points
// do not suffice far away.
template <class Visit>
void each_part(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
               Visit&& visit) {
    uint32_t next = 0;
    for (const SeenPlant& plant : seen.plants)
        for (; next < plant.part_end; ++next) {
            const SeenPart& seen_part = seen.parts[next];
            const PackedPart& part = geometry.parts[seen_part.part];
            const PartCells cells = geometry.part_cells[seen_part.part];
            // Only cells have points to go on with where the part's are used up, and blend.
            if (cells.count == 0 || !settings.level_of_detail ||
                !draws_triangles(part, seen_part.projected, settings)) {
                visit(plant, seen_part.part, seen_part.projected);
                continue;
            }
            for (uint32_t cell = cells.first; cell < cells.first + cells.count; ++cell)
                visit(plant, cell, project_part(geometry.parts[cell], plant.view, settings.projection));
        }
}

// What draw_plants will draw.
void measure_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                    BudgetHistogram& histogram);

}  // namespace coppice
