// All plants in view of a frame, in parallel: seen once, measured as often as its budget asks, then drawn.
#pragma once
#include "plugins/vegetation/draw/expand_plants.h"

namespace coppice {

class FramePlants {
  public:
    // Of the list's runs; horizon and spread_px as for see_plants. The list must hold until the last draw, and what was seen until
    // that has been gathered.
    void see(const TileList& tiles, const SceneGeometry& geometry, const Frustum& frustum,
             const Horizon* horizon, float spread_px);

    // What draw will draw, by d', gains and cells taken at the settings' d'. Holds until the next call.
    const BudgetHistogram& measure(const TileList& tiles, const SceneGeometry& geometry,
                                   const Frustum& frustum, const FrameSettings& settings);

    // Run i into part first_part + i of the work list, clouds into the one behind.
    void draw(const TileList& tiles, const SceneGeometry& geometry, const Frustum& frustum,
              const FrameSettings& settings, uint32_t rest_index, WorkList& work, size_t first_part) const;

    // Of each of the list's runs.
    std::span<const SeenPlants> seen() const { return std::span(seen_).first(run_count_); }
    // From the viewer to what was seen, clouds too: an estimate. Infinite where nothing was.
    float nearest_m(const TileList& tiles) const;
    // Of what was seen.
    void count(uint32_t& visible, uint32_t& hidden, uint64_t& full_triangles) const;

  private:
    std::vector<SeenPlants> seen_;  // of each run; kept, as all here, so that a warm frame allocates nothing
    size_t run_count_ = 0;
    std::vector<BudgetHistogram>
        measured_;  // one a job, since they are large; sums do not depend on who adds
};

}  // namespace coppice
