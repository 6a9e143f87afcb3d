#include "tools/coppice/compare_folders.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <fmt/format.h>
#include "plugins/shared/json_object.h"
#include "runtime/core/file.h"
#include "tools/coppice/rank_tests.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

constexpr const char* k_counts[] = {"vertices",      "triangles",    "lines",       "points",       "leaves",
                                    "tiles_touched", "device_bytes", "allocations", "tiles_missing"};

struct Report {
    nlohmann::json summary;
    std::vector<double> repeat_ms;         // median frame of each repeat
    std::map<std::string, double> counts;  // means over frames
};

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> pieces;
    for (size_t first = 0; first <= text.size();) {
        const size_t end = std::min(text.find(separator, first), text.size());
        pieces.push_back(text.substr(first, end - first));
        first = end + 1;
    }
    return pieces;
}

Result<double> parse_cell(const std::string& file, size_t line, std::string_view cell) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
        return fail(ErrorId::syntax, file, fmt::format("line {}", line + 1),
                    fmt::format("'{}' is no number", cell), "a table that coppice play wrote");
    return value;
}

Status read_frames(const std::string& file, Report& report) {
    COPPICE_TRY(const std::string text, read_text_file(file));
    std::vector<std::string_view> lines = split(text, '\n');
    while (!lines.empty() && lines.back().empty()) lines.pop_back();
    const std::vector<std::string_view> head =
        lines.empty() ? std::vector<std::string_view>() : split(lines.front(), ',');
    auto column = [&](const char* name) {
        return size_t(std::find(head.begin(), head.end(), name) - head.begin());
    };
    const size_t repeat_column = column("repeat"), time_column = column("FrameTime");
    if (repeat_column == head.size() || time_column == head.size() || lines.size() < 2)
        return fail(ErrorId::format_unknown, file, "line 1", "no columns repeat and FrameTime, or no frame",
                    "a table that this version's coppice play wrote");
    std::map<double, std::vector<double>> frames_ms;
    for (size_t line = 1; line < lines.size(); ++line) {
        const std::vector<std::string_view> cells = split(lines[line], ',');
        if (cells.size() != head.size())
            return fail(ErrorId::syntax, file, fmt::format("line {}", line + 1),
                        fmt::format("{} cells", cells.size()), fmt::format("{}, as in line 1", head.size()));
        COPPICE_TRY(const double repeat, parse_cell(file, line, cells[repeat_column]));
        COPPICE_TRY(const double ms, parse_cell(file, line, cells[time_column]));
        frames_ms[repeat].push_back(ms);
        for (const char* name : k_counts) {
            if (column(name) == head.size()) continue;
            COPPICE_TRY(const double count, parse_cell(file, line, cells[column(name)]));
            report.counts[name] += count / double(lines.size() - 1);
        }
    }
    for (const auto& [repeat, ms] : frames_ms) report.repeat_ms.push_back(median(ms));
    return {};
}

Result<Report> read_report(const std::string& folder) {
    Report report;
    const std::string file = folder + "/summary.json";
    COPPICE_TRY(const std::string text, read_text_file(file));
    COPPICE_TRY(const JsonDocument summary, JsonDocument::parse(text, file));
    report.summary = summary.root();
    for (const char* key : {"settings", "machine", "scene"})
        if (!report.summary.is_object() || !report.summary.contains(key) || !report.summary[key].is_object())
            return fail(ErrorId::syntax, file, key, "is not there, or no object",
                        "a report that coppice play wrote");
    COPPICE_CHECK(read_frames(folder + "/frames.csv", report));
    return report;
}

Effect against_itself(const std::vector<double>& repeat_ms) {
    std::vector<double> halves[2];
    for (size_t i = 0; i < repeat_ms.size(); ++i) halves[i % 2].push_back(repeat_ms[i]);
    Effect effect = effect_of_times(halves[0], halves[1]);
    // Halves are too few to be rare: how far they are apart must be enough.
    effect.chance = 0.0;
    return effect;
}

}  // namespace

Result<Comparison> compare_folders(const std::string& base_folder, const std::string& new_folder,
                                   double floor_share) {
    COPPICE_TRY(const Report base, read_report(base_folder));
    COPPICE_TRY(const Report changed, read_report(new_folder));
    auto settings = [](const Report& report) {
        nlohmann::json of_flight = report.summary["settings"];
        of_flight.erase("repeats");
        return of_flight;
    };
    if (settings(base) != settings(changed) || base.summary["scene"] != changed.summary["scene"])
        return fail(ErrorId::usage, new_folder + "/summary.json", "settings",
                    "another scene, or flown with other settings", "the same command for both");
    for (const auto& [folder, report] : {std::pair(base_folder, &base), std::pair(new_folder, &changed)})
        if (report->repeat_ms.size() < k_least_repeats)
            return fail(ErrorId::usage, folder + "/frames.csv", "",
                        fmt::format("{} repeats", report->repeat_ms.size()),
                        fmt::format("fly with --repeats {} or more", k_least_repeats));
    Comparison comparison;
    comparison.base_ms = median(base.repeat_ms);
    comparison.new_ms = median(changed.repeat_ms);
    comparison.effect = effect_of_times(base.repeat_ms, changed.repeat_ms);
    comparison.itself = against_itself(base.repeat_ms);
    comparison.samples = std::min(base.repeat_ms.size(), changed.repeat_ms.size());
    comparison.floor_share = floor_share;
    comparison.same_machine = base.summary["machine"] == changed.summary["machine"];
    comparison.counts = compare_counts(base.counts, {}, changed.counts, floor_share);
    return comparison;
}

}  // namespace coppice
