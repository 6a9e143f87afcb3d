// What is in view of a run of plants: culled and looked at once, whatever d'. A budget measures it, perhaps several
// times, and then it is drawn; both go over it by each_part, so that what is drawn is what was measured. Plants of one
// model are a group, and what is said of each of them stands in columns, so that loops over them are made vectors of.
#pragma once
#include <algorithm>
#include "plugins/vegetation/cull/horizon.h"
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/draw/work_list.h"
#include "plugins/vegetation/lod/budget.h"

namespace coppice {

// Plants [first, end) of a run's, of one model; at most k_plants_a_batch.
struct SeenGroup {
    uint32_t model, first, end;
};

// An octree cell of a plant so near that it is looked at from the cell's own place.
struct SeenCell {
    uint32_t plant, part, part_of_model;
    PlantView view;
};

// Kept from frame to frame, so that a warm frame allocates nothing. Columns are as long as the run may be, and hold
// plant_count plants.
struct SeenPlants {
    uint32_t plant_count = 0;
    std::vector<float> direction_x, direction_y, direction_z, pixels_per_meter;  // PlantView
    std::vector<uint32_t> seed;                                                  // PlantModel::seed
    std::vector<uint8_t> in_cells;  // 1: parts that have cells are drawn as these
    std::vector<WorkInstance> instances;
    std::vector<SeenGroup> groups;
    std::vector<SeenCell> cells;
    uint32_t hidden_plants = 0;   // in view, but behind the ground
    float nearest_m = INFINITY;   // from the viewer to a plant, as estimate_nearest_m says
    uint64_t full_triangles = 0;  // had all been drawn

    PlantViews views(const SeenGroup& group) const {
        auto part = [&](const std::vector<float>& all) {
            return std::span(all).subspan(group.first, group.end - group.first);
        };
        return {part(direction_x), part(direction_y), part(direction_z), part(pixels_per_meter)};
    }
};

// From the viewer to what is nearest of a plant: to the sphere that holds it, or from within it, since crowns are hollow near
// their middle, a third of its radius. An estimate: for what may be off, not for what may be left out.
inline float estimate_nearest_m(float distance_m, float radius_m) {
    return std::max(distance_m - radius_m, radius_m * (1.0f / 3.0f));
}

// Any thread. horizon: for runs that may have plants behind it (PlantRun::may_be_hidden); nullptr: nothing is hidden.
// spread_px: widest_spread_px.
void see_plants(const PlantRun& run, const SceneGeometry& geometry, const Frustum& frustum,
                const Horizon* horizon, float spread_px, SeenPlants& seen);

// A part of a group's plants: those whose left_out is 0.
struct SeenPart {
    uint32_t first_plant;
    uint32_t part, part_of_model;  // of the scene's geometry, of the model's
    const PartRule& rule;
    const PartDemands& demands;
    std::span<const uint8_t> left_out;  // as long as the group
};

// Visits all that is drawn at the settings' d': many(SeenPart) of parts in one piece; cell(plant, part, part_of_model, rule, demand)
// of octree cells in place of a part, of plants that are near and where the part's own points or lines do not suffice.
template <class Many, class Cell>
void each_part(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
               Many&& many, Cell&& cell) {
    PartDemands demands{};
    PlantColumn<uint8_t> left_out;
    auto visit_cell = [&](uint32_t plant, uint32_t part, uint32_t part_of_model, const PlantView& view) {
        const PackedPart& of = geometry.parts[part];
        const PartRule rule(of, settings);
        cell(plant, part, part_of_model, rule, rule.demand(project_part(of, view, settings)));
    };
    for (const SeenGroup& group : seen.groups) {
        const DrawModel& model = geometry.models[group.model];
        const PlantViews views = seen.views(group);
        for (uint32_t part = model.first_part; part < model.first_part + model.part_count; ++part) {
            const PartRule rule(geometry.parts[part], settings, geometry.part_geometry[part].leaves);
            const PartCells cells = geometry.part_cells[part];
            rule.demand(geometry.parts[part], views, settings, demands);
            for (size_t i = 0; i < views.size(); ++i) {
                left_out[i] = cells.count > 0 && seen.in_cells[group.first + i];
                // Only cells have points to go on with where the part's are used up, and blend.
                if (cells.count == 0 || left_out[i] || !settings.level_of_detail ||
                    !rule.draws_triangles(demands[i]))
                    continue;
                left_out[i] = 1;
                for (uint32_t c = cells.first; c < cells.first + cells.count; ++c)
                    visit_cell(group.first + uint32_t(i), c, c - model.first_part, views[i]);
            }
            many(SeenPart{group.first, part, part - model.first_part, rule, demands,
                          std::span(left_out).first(views.size())});
        }
    }
    for (const SeenCell& near : seen.cells) visit_cell(near.plant, near.part, near.part_of_model, near.view);
}

// What draw_plants will draw.
void measure_plants(const SeenPlants& seen, const SceneGeometry& geometry, const FrameSettings& settings,
                    BudgetHistogram& histogram);

}  // namespace coppice
