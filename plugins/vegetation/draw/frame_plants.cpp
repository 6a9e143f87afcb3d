#include "plugins/vegetation/draw/frame_plants.h"

#include <algorithm>
#include <atomic>
#include "runtime/core/jobs.h"

namespace coppice {

void FramePlants::see(const TileList& tiles, const SceneGeometry& geometry, const Frustum& frustum,
                      const Horizon* horizon, float spread_px) {
    const std::span<const PlantRun> runs = tiles.runs();
    run_count_ = runs.size();
    if (seen_.size() < run_count_) seen_.resize(run_count_);
    parallel_for(run_count_, 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            see_plants(runs[i], geometry, frustum, runs[i].may_be_hidden ? horizon : nullptr, spread_px,
                       seen_[i]);
    });
}

const BudgetHistogram& FramePlants::measure(const TileList& tiles, const SceneGeometry& geometry,
                                            const Frustum& frustum, const FrameSettings& settings) {
    const size_t job_count = std::clamp<size_t>(thread_limit(), 1, std::max<size_t>(run_count_, 1));
    if (measured_.size() < job_count) measured_.resize(job_count);
    std::atomic<size_t> next{0};
    parallel_for(job_count, 1, [&](size_t first, size_t last) {
        for (size_t job = first; job < last; ++job) {
            measured_[job].clear();
            if (job == 0) measure_clouds(tiles.clouds(), geometry, frustum, settings, measured_[job]);
            for (size_t run; (run = next++) < run_count_;)
                measure_plants(seen_[run], geometry, settings, measured_[job]);
        }
    });
    for (size_t job = 1; job < job_count; ++job) measured_[0].add(measured_[job]);
    return measured_[0];
}

void FramePlants::draw(const TileList& tiles, const SceneGeometry& geometry, const Frustum& frustum,
                       const FrameSettings& settings, uint32_t rest_index, WorkList& work,
                       size_t first_part) const {
    parallel_for(run_count_ + 1, 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            WorkPart& part = work.part(first_part + i);
            if (i < run_count_)
                draw_plants(seen_[i], geometry, settings, rest_index, part);
            else
                expand_clouds(tiles.clouds(), geometry, frustum, settings, part);
        }
    });
}

float FramePlants::nearest_m(const TileList& tiles) const {
    float nearest_m = INFINITY;
    for (const CloudTile& cloud : tiles.clouds()) nearest_m = std::min(nearest_m, cloud.nearest_m);
    for (size_t i = 0; i < run_count_; ++i) nearest_m = std::min(nearest_m, seen_[i].nearest_m);
    return nearest_m;
}

void FramePlants::count(uint32_t& visible, uint32_t& hidden, uint64_t& full_triangles) const {
    visible = hidden = 0;
    full_triangles = 0;
    for (size_t i = 0; i < run_count_; ++i) {
        visible += seen_[i].plant_count;
        hidden += seen_[i].hidden_plants;
        full_triangles += seen_[i].full_triangles;
    }
}

}  // namespace coppice
