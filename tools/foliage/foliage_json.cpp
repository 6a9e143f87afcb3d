#include "tools/foliage/foliage_record.h"

namespace coppice {

nlohmann::json foliage_json(const FoliageRecord& record) {
    static constexpr const char* k_names[k_structure_count] = {"vdf", "lodf", "lifetimes"};
    nlohmann::json sweep = nlohmann::json::array(), levels = sweep, drawn = sweep, dropped = sweep;
    for (const SweepStep& step : record.sweep) {
        nlohmann::json row{{"leaves", step.leaf_count},
                           {"lifetimes_scan_ms", step.scan_ms},
                           {"lifetimes_candidates", step.candidate_count}};
        for (size_t s = 0; s < k_structure_count; ++s)
            row[k_names[s]] = {{"extract_ms", step.change[s].extract_ms},
                               {"copy_ms", step.change[s].copy_ms},
                               {"bytes", step.change[s].bytes}};
        sweep.push_back(std::move(row));
    }
    for (const CrownLevelRecord& level : record.levels)
        levels.push_back(
            {{"leaves", level.leaf_count}, {"coverage_error", level.coverage_error}, {"area", level.area}});
    for (const DrawnLevelRecord& level : record.drawn)
        drawn.push_back({{"leaves", level.leaf_count},
                         {"leaves_ms", level.leaves_ms},
                         {"vdf_change_ms", level.vdf_ms},
                         {"lifetimes_change_ms", level.ours_ms},
                         {"picture", level.picture_file}});
    for (const DroppedErrors& level : record.dropped)
        dropped.push_back({{"leaves", level.leaf_count},
                           {"w_0", level.unscaled},
                           {"w_half", level.half},
                           {"w_1", level.whole},
                           {"tolerant", level.tolerant},
                           {"w_1_golden", level.whole_golden},
                           {"w_1_golden_printed", level.whole_printed}});
    return {{"name", record.name},           {"leaves", record.leaf_count}, {"collapse_s", record.collapse_s},
            {"grove", record.grove_file},    {"sweep", std::move(sweep)},   {"levels", std::move(levels)},
            {"dropped", std::move(dropped)}, {"drawn", std::move(drawn)}};
}

}  // namespace coppice
