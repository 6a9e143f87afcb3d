#include "plugins/vegetation/report/explain_frame.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>

namespace coppice {
namespace {

// Name and importance, which variations of a plant share, and the power of two of the distance in m.
using Key = std::tuple<std::string_view, float, int>;

void add(PrimitiveCounts& to, const PartChoice& choice) {
    to.triangles += choice.triangles;
    to.lines += choice.lines;
    to.points += choice.points - choice.skipped_points;
    to.leaves += choice.leaves;
}

class Explainer {
  public:
    explicit Explainer(const ExplainedFrame& frame) : frame_(frame), turn_(rest_turn(frame.rest_index)) {}

    void explain(const SeenPlants& seen) {
        row_of_.assign(seen.plant_count, nullptr);
        for (const SeenGroup& group : seen.groups)
            for (uint32_t plant = group.first; plant < group.end; ++plant) place(seen, group.model, plant);
        each_part(
            seen, frame_.geometry, frame_.drawn,
            [&](const SeenPart& many) {
                for (size_t i = 0; i < many.left_out.size(); ++i)
                    if (!many.left_out[i])
                        add_part(seen, many.first_plant + uint32_t(i), many.part_of_model, many.rule,
                                 many.demands[i]);
            },
            [&](uint32_t plant, uint32_t, uint32_t part_of_model, const PartRule& rule,
                const PartDemand& demand) { add_part(seen, plant, part_of_model, rule, demand); });
    }

    std::vector<ExplainedPlants> take() {
        std::vector<ExplainedPlants> rows;
        for (auto& [key, row] : rows_) rows.push_back(std::move(row));
        std::ranges::stable_sort(rows, std::greater{},
                                 [](const ExplainedPlants& row) { return vertices_of(row.drawn); });
        return rows;
    }

  private:
    void place(const SeenPlants& seen, uint32_t model, uint32_t plant) {
        const WorkInstance& at = seen.instances[plant];
        const float distance_m = glm::length(vec3(at.x_camera, at.y_camera, at.z_camera));
        const SceneModel& of = frame_.models[model];
        auto [row, is_new] =
            rows_.try_emplace(Key{of.name, of.importance, distance_m >= 1.0f ? std::ilogb(distance_m) : 0});
        ExplainedPlants& plants = row->second;
        if (is_new) {
            plants.model = of.name;
            plants.importance = of.importance;
            plants.nearest_m = distance_m;
        }
        plants.nearest_m = std::min(plants.nearest_m, distance_m);
        plants.farthest_m = std::max(plants.farthest_m, distance_m);
        ++plants.plants;
        plants.full_triangles += frame_.geometry.models[model].triangle_count;
        row_of_[plant] = &plants;
    }

    void add_part(const SeenPlants& seen, uint32_t plant, uint32_t part_of_model, const PartRule& rule,
                  const PartDemand& demand) {
        const PartRule::Choice choice =
            rule.choose(demand, turned_chance(seen.seed[plant], part_of_model, turn_));
        const PartChoice chosen = rule.expand(choice, demand.side_gain);
        ExplainedPlants& row = *row_of_[plant];
        if (chosen.triangles + chosen.points + chosen.lines + chosen.leaves == 0)
            ++row.parts_of_nothing;
        else
            ++row.parts_as[size_t(choice.form)];
        add(row.drawn, chosen);
    }

    const ExplainedFrame& frame_;
    float turn_;
    std::map<Key, ExplainedPlants> rows_;
    std::vector<ExplainedPlants*> row_of_;
};

SampleDistanceReason reason_of(const ExplainedFrame& frame, const FrameReport& report) {
    if (!frame.drawn.level_of_detail) return SampleDistanceReason::no_levels;
    if (report.rested_frames > 0) return SampleDistanceReason::rest;
    if (report.vertex_budget == 0 || frame.drawn.sample_distance_px <= frame.asked.sample_distance_px)
        return SampleDistanceReason::asked;
    return report.vertices > report.vertex_budget &&
                   frame.drawn.sample_distance_px >= frame.asked.most_sample_distance_px
               ? SampleDistanceReason::most
               : SampleDistanceReason::budget;
}

}  // namespace

FrameExplanation explain_frame(const ExplainedFrame& frame, const FrameReport& report) {
    FrameExplanation explained;
    explained.report = report;
    explained.reason = reason_of(frame, report);
    explained.asked_distance_px = frame.asked.sample_distance_px;
    Explainer explainer(frame);
    for (const SeenPlants& seen : frame.plants.seen()) {
        explainer.explain(seen);
        explained.plants_seen += seen.plant_count;
        explained.plants_hidden += seen.hidden_plants;
    }
    explained.plants = explainer.take();
    WorkPart work;
    for (const CloudTile& tile : frame.tiles.clouds()) {
        work.clear();
        expand_clouds({&tile, 1}, frame.geometry, frame.frustum, frame.drawn, work);
        explained.clouds.push_back({tile.nearest_m,
                                    tile.plant_count,
                                    tile.triangle_count,
                                    tile.stands_in,
                                    {work.triangles, work.lines, work.points, work.leaves}});
        explained.plants_in_clouds += tile.plant_count;
    }
    const uint64_t accounted = explained.plants_seen + explained.plants_hidden + explained.plants_in_clouds;
    explained.plants_elsewhere = frame.tiles.plant_count - std::min(frame.tiles.plant_count, accounted);
    return explained;
}

}  // namespace coppice
