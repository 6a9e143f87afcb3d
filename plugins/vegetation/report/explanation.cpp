#include "plugins/vegetation/report/explanation.h"

#include <algorithm>
#include <iterator>
#include <fmt/format.h>

namespace coppice {
namespace {

constexpr const char* k_form_names[ExplainedPlants::k_forms] = {
    "triangles", "points", "points and triangles", "lines", "line points", "leaves"};

std::string why_sample_distance(const FrameExplanation& explanation) {
    const FrameReport& report = explanation.report;
    switch (explanation.reason) {
        case SampleDistanceReason::asked:
            return "as asked for";
        case SampleDistanceReason::budget:
            return fmt::format("{:.3g} px asked for, more than {} vertices", explanation.asked_distance_px,
                               report.vertex_budget);
        case SampleDistanceReason::most:
            return fmt::format("the most allowed, and still more than {} vertices", report.vertex_budget);
        case SampleDistanceReason::rest:
            return fmt::format("resting for {} frames", report.rested_frames);
        case SampleDistanceReason::no_levels:
            break;
    }
    return "not used: every triangle";
}

std::string forms_of(const ExplainedPlants& plants) {
    std::string forms;
    for (size_t form = 0; form < ExplainedPlants::k_forms; ++form)
        if (plants.parts_as[form] > 0)
            forms +=
                fmt::format("{}{} {}", forms.empty() ? "" : ", ", plants.parts_as[form], k_form_names[form]);
    if (plants.parts_of_nothing > 0)
        forms += fmt::format("{}{} nothing", forms.empty() ? "" : ", ", plants.parts_of_nothing);
    return forms;
}

}  // namespace

std::string to_text(const FrameExplanation& explanation) {
    const FrameReport& report = explanation.report;
    std::string text;
    auto out = std::back_inserter(text);
    fmt::format_to(out, "d' {:.3f} px: {}\n", report.sample_distance_px, why_sample_distance(explanation));
    fmt::format_to(out, "{} plants: {} one by one, {} in {} clouds, {} behind the ground, {} elsewhere\n",
                   report.plants, explanation.plants_seen, explanation.plants_in_clouds,
                   explanation.clouds.size(), explanation.plants_hidden, explanation.plants_elsewhere);
    fmt::format_to(
        out, "{} vertices: {} triangles, {} leaves, {} lines, {} points; {} triangles without levels\n",
        report.vertices, report.triangles, report.leaves, report.lines, report.points, report.full_triangles);
    if (report.dropped_entries + report.dropped_triangles > 0)
        fmt::format_to(out, "not drawn for want of memory: {} entries, {} large triangles\n",
                       report.dropped_entries, report.dropped_triangles);
    if (report.shadow_maps > 0)
        fmt::format_to(out, "{} shadow maps were drawn, of {} plants, beside this\n", report.shadow_maps,
                       report.shadow_plants);
    auto share = [&](const PrimitiveCounts& drawn) {
        return 100.0 * double(vertices_of(drawn)) / double(std::max<uint64_t>(report.vertices, 1));
    };
    fmt::format_to(out, "\n{:>7} {:>9} {:>16} {:>8} {:>10}  {}\n", "share", "vertices", "distance", "plants",
                   "importance", "model: its parts as");
    for (const ExplainedPlants& plants : explanation.plants)
        fmt::format_to(out, "{:>6.1f}% {:>9} {:>14} m {:>8} {:>10.3g}  {}: {}\n", share(plants.drawn),
                       vertices_of(plants.drawn),
                       fmt::format("{:.0f} to {:.0f}", plants.nearest_m, plants.farthest_m), plants.plants,
                       plants.importance, plants.model, forms_of(plants));
    PrimitiveCounts of_clouds;
    size_t standing_in = 0;
    for (const ExplainedCloud& cloud : explanation.clouds) {
        of_clouds.points += cloud.drawn.points;
        standing_in += cloud.stands_in;
    }
    if (!explanation.clouds.empty())
        fmt::format_to(
            out, "{:>6.1f}% {:>9} {:>14} m {:>8} {:>10}  {} clouds of tiles{}\n", share(of_clouds),
            vertices_of(of_clouds),
            fmt::format("{:.0f} to {:.0f}", explanation.clouds.front().nearest_m,
                        explanation.clouds.back().nearest_m),
            explanation.plants_in_clouds, "", explanation.clouds.size(),
            standing_in > 0 ? fmt::format(", {} in place of what is still being read", standing_in) : "");
    return text;
}

}  // namespace coppice
