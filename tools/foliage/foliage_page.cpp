#include <algorithm>
#include <array>
#include <functional>
#include <fmt/format.h>
#include "tools/accuracy/log_plot.h"
#include "tools/coppice/page_style.h"
#include "tools/coppice/page_text.h"
#include "tools/foliage/foliage_record.h"

namespace coppice {
namespace {

struct StructureLook {
    const char *name, *color;
};
constexpr std::array<StructureLook, k_structure_count> k_looks{
    {{"VDF", "#b4545c"}, {"LoDF", "#c08a2d"}, {"leaf lifetimes", "#2f6b3f"}}};

constexpr size_t k_markers = 25;  // of a line; more would hide each other
constexpr const char* k_own_style = R"(
.legend svg { width:34px; display:inline-block; vertical-align:middle; margin-right:6px }
)";

LineStyle style_of(size_t structure) {
    return {fmt::format("s{}", structure), k_looks[structure].color, uint32_t(structure), structure == 2};
}

using StepValue = std::function<double(const SweepStep& step, size_t structure)>;

// Over the leaves of the level gone to.
std::string sweep_plot(const FoliageRecord& record, const std::string& label, const char* unit,
                       const StepValue& value) {
    std::vector<LogPlotSeries> series;
    std::vector<double> all_x, all_y;
    for (size_t s = 0; s < k_structure_count; ++s) {
        LogPlotSeries line{style_of(s), {}};
        const size_t stride = std::max<size_t>(record.sweep.size() / k_markers, 1);
        for (size_t i = stride - 1; i < record.sweep.size(); i += stride) {
            const double x = record.sweep[i].leaf_count, y = value(record.sweep[i], s);
            line.points.push_back(
                {x, y, fmt::format("{}, {:.0f} leaves: {:.4g} {}", k_looks[s].name, x, y, unit)});
            all_x.push_back(x);
            all_y.push_back(y);
        }
        series.push_back(std::move(line));
    }
    LogPlotSettings settings;
    settings.label = label + ", " + record.name;
    settings.x_name = "leaves of the level";
    settings.x = log_range(all_x);
    settings.y = log_range(all_y);
    return fmt::format("<figure class=\"plot\">{}<figcaption>{}, {}</figcaption></figure>\n",
                       log_plot(series, settings), escape_html(label), unit);
}

std::string legend() {
    std::string text = "<p class=\"legend\">";
    for (size_t s = 0; s < k_structure_count; ++s)
        text += fmt::format("<span>{} {}</span>", line_key(style_of(s)), k_looks[s].name);
    return text + "</p>\n";
}

// Every tenth step.
std::string sweep_table(const FoliageRecord& record) {
    std::string rows;
    const size_t stride = std::max<size_t>(record.sweep.size() / 10, 1);
    for (size_t i = stride - 1; i < record.sweep.size(); i += stride) {
        const SweepStep& step = record.sweep[i];
        rows += fmt::format("<tr><td>{}</td>", step.leaf_count);
        for (const ChangeCost& cost : step.change)
            rows += fmt::format("<td>{:.4f}</td><td>{:.4f}</td><td>{}</td>", cost.extract_ms,
                                cost.extract_ms + cost.copy_ms, cost.bytes);
        rows += fmt::format("<td>{:.4f}</td></tr>\n", step.scan_ms);
    }
    std::string head = "<tr><th>leaves</th>";
    for (const StructureLook& look : k_looks)
        head += fmt::format("<th>{0}: extraction, ms</th><th>and copy, ms</th><th>bytes</th>", look.name);
    return fmt::format("<table class=\"numbers\">{}<th>their scan, ms</th></tr>\n{}</table>\n", head, rows);
}

std::string level_table(const FoliageRecord& record) {
    std::string rows;
    for (const CrownLevelRecord& level : record.levels)
        rows += fmt::format("<tr><td>{}</td><td>{:.2f}</td><td>{:.3f}</td></tr>\n", level.leaf_count,
                            100.0 * level.coverage_error, 100.0 * (level.area - 1.0));
    return "<table class=\"numbers\"><tr><th>leaves</th><th>coverage off by at most, %</th><th>area off by, "
           "%</th></tr>\n" +
           rows + "</table>\n";
}

std::string dropped_table(const FoliageRecord& record) {
    std::string rows;
    for (const DroppedErrors& level : record.dropped)
        rows += fmt::format(
            "<tr><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td>"
            "<td>{:.1f}</td></tr>\n",
            level.leaf_count, 100.0 * level.unscaled, 100.0 * level.half, 100.0 * level.whole,
            100.0 * level.tolerant, 100.0 * level.whole_golden, 100.0 * level.whole_printed);
    return "<table class=\"numbers\"><tr><th>leaves</th><th>w = 0</th><th>w = 0.5</th><th>w = "
           "1</th><th>tolerant of 2 %</th>"
           "<th>w = 1, golden section</th><th>the same as printed</th></tr>\n" +
           rows + "</table>\n";
}

std::string pictures(const FoliageRecord& record) {
    std::string text = "<div class=\"pictures\">\n";
    for (const DrawnLevelRecord& level : record.drawn)
        text += fmt::format(
            "<figure><img src=\"{0}\" alt=\"{1} with {2} leaves\"><figcaption>{2} leaves: {3:.1f} "
            "ms</figcaption></figure>\n",
            level.picture_file, escape_html(record.name), level.leaf_count, level.leaves_ms);
    if (!record.grove_file.empty())
        text += fmt::format(
            "<figure><img src=\"{0}\" alt=\"{1}, a grove\"><figcaption>levels by "
            "distance</figcaption></figure>\n",
            record.grove_file, escape_html(record.name));
    return text + "</div>\n";
}

std::string section(const FoliageRecord& record) {
    const auto extraction = [](const SweepStep& step, size_t s) {
        return s == size_t(FoliageStructure::lifetimes) ? step.scan_ms : step.change[s].extract_ms;
    };
    const auto change = [](const SweepStep& step, size_t s) {
        return step.change[s].extract_ms + step.change[s].copy_ms;
    };
    const auto bytes = [](const SweepStep& step, size_t s) { return double(step.change[s].bytes); };
    return fmt::format(
               "<h2>{}</h2><p>{} leaves, joined to a twentieth in {:.2f} s. Words a vertex: {:.2f} as "
               "clusters, {:.2f} as one "
               "list (the paper: 6.25).</p>\n",
               escape_html(record.name), record.leaf_count, record.collapse_s, record.forest_words,
               record.lifetimes_words) +
           legend() + "<div class=\"pictures\">\n" +
           sweep_plot(record, "Extraction; of lifetimes the scan that is left to whoever draws", "ms",
                      extraction) +
           sweep_plot(record, "Extraction and copy", "ms", change) +
           sweep_plot(record, "Sent", "bytes", bytes) + "</div>\n" + sweep_table(record) +
           "<p>Four levels, every triangle; milliseconds a frame with the leaves alone.</p>\n" +
           pictures(record) + "<p>Against the full crown, from 16 directions:</p>\n" + level_table(record) +
           "<p>Leaves dropped and the rest resized, in place of joined; coverage off by at most, %. In "
           "progressive order along a curve, the last two columns in golden-section order:</p>\n" +
           dropped_table(record);
}

}  // namespace

std::string foliage_page(const std::vector<FoliageRecord>& records, const std::string& device,
                         const std::string& machine, const std::string& command) {
    std::string sections;
    for (const FoliageRecord& record : records) sections += section(record);
    return fmt::format(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Coppice: "
        "foliage</title><style>{}{}</style>"
        "<main><h1>Changing the level of a crown</h1><p>From the full crown to a twentieth of its leaves in "
        "uniform steps, "
        "after Figs. 10 to 12 of Rebollo et al. 2006. VDF finds and sends all leaves of each level; LoDF "
        "those of the clusters "
        "that changed; with leaf lifetimes the level alone is sent, and whoever draws skips what is not "
        "born: the list has up "
        "to twice as many leaves as are drawn, and what scanning it takes on one core is shown beside.</p>"
        "<p class=\"soft\">{}, {}. Medians, structures in turns, a leaf sent as its number. "
        "<code>{}</code></p>\n{}</main></html>\n",
        k_page_style, k_own_style, escape_html(device), escape_html(machine), escape_html(command), sections);
}

}  // namespace coppice
