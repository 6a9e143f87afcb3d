#include "tools/coppice/play_check.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "tools/coppice/frame_pace.h"
#include "tools/coppice/play_record.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

using Frames = std::span<const FrameRecord>;

struct Measure {
    BudgetKind kind;
    std::function<double(const PlayRecord&, Frames)> value;  // of one repeat
};

template <class Value>
std::vector<double> each(Frames frames, Value value) {
    std::vector<double> values;
    for (const FrameRecord& frame : frames) values.push_back(double(value(frame)));
    return values;
}

template <class Value>
double most(Frames frames, Value value) {
    return quantile(each(frames, value), 1.0);
}

template <class Value>
double p95(Frames frames, Value value) {
    return quantile(each(frames, value), 0.95);
}

const std::vector<Measure>& measures() {
    using R = const PlayRecord&;
    constexpr double k_mib = 1 << 20;
    static const std::vector<Measure> k_measures{
        {{"frame", "ms", "p95 of a frame's time", true},
         [](R, Frames f) { return p95(f, [](auto& one) { return one.wall_ms; }); }},
        {{"cpu", "ms", "p95 of what the CPU works until the frame is submitted", true},
         [](R, Frames f) { return p95(f, [](auto& one) { return one.cpu_ms; }); }},
        {{"gpu", "ms", "p95 of the passes' time on the device", true},
         [](R, Frames f) { return p95(f, [](auto& one) { return device_ms(one); }); }},
        {{"hitches", "frames", "frames twice as long as those around them and 4 ms longer", true},
         [](R, Frames f) {
             return double(measure_pace(each(f, [](auto& one) { return one.wall_ms; })).hitches);
         }},
        {{"load", "ms", "from the start until the first frame can be drawn", true},
         [](R record, Frames) { return load_ms(record.load); }},
        {{"memory", "MiB", "most the process had in memory", false},
         [](R record, Frames) { return double(record.peak_memory_bytes) / k_mib; }},
        {{"device-memory", "MiB", "most the buffers on the device held", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.gpu_bytes; }) / k_mib; }},
        {{"error", "FLIP", "mean FLIP against every triangle, of the worst frame compared", false},
         [](R record, Frames) {
             double worst = record.compared.empty() ? 1.0 : 0.0;
             for (const ComparedFrame& frame : record.compared) worst = std::max(worst, frame.flip);
             return worst;
         }},
        {{"vertices", "a frame", "most vertices of plants", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.vertices; }); }},
        {{"triangles", "a frame", "most triangles of plants", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.triangles; }); }},
        {{"lines", "a frame", "most lines of plants", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.lines; }); }},
        {{"points", "a frame", "most points of plants", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.points; }); }},
        {{"leaves", "a frame", "most leaves of crowns", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.leaves; }); }},
        {{"tiles", "a frame", "most tiles looked at", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.tiles_touched; }); }},
        {{"tiles-missing", "a frame", "most clouds in place of what was not in memory yet", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.report.tiles_missing; }); }},
        {{"allocations", "a frame", "most calls of operator new", false},
         [](R, Frames f) { return most(f, [](auto& one) { return one.allocations; }); }},
    };
    return k_measures;
}

struct Suffix {
    const char* text;
    double factor;
};

std::vector<Suffix> suffixes_of(const BudgetKind& kind) {
    const std::string_view unit = kind.unit;
    if (unit == "ms") return {{"ms", 1.0}, {"us", 1e-3}, {"s", 1e3}};
    if (unit == "MiB") return {{"MiB", 1.0}, {"GiB", 1024.0}, {"KiB", 1.0 / 1024.0}, {"B", 1.0 / 1048576.0}};
    return {{"", 1.0}};
}

Result<double> parse_limit(const BudgetKind& kind, std::string_view text) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view rest = text.substr(size_t(end - text.data()));
    if (error == std::errc() && std::isfinite(number) && number >= 0.0)
        for (const Suffix& suffix : suffixes_of(kind))
            if (rest == suffix.text) return number * suffix.factor;
    std::vector<std::string> examples;
    for (const Suffix& suffix : suffixes_of(kind))
        examples.push_back(fmt::format("{}=8{}", kind.name, suffix.text));
    return fail(ErrorId::usage, "", "--budget", fmt::format("'{}' is no limit of {}", text, kind.name),
                fmt::format("write {}", fmt::join(examples, " or ")));
}

std::vector<Frames> repeats_of(const PlayRecord& record) {
    std::vector<Frames> repeats;
    const Frames frames = record.frames;
    for (size_t first = 0; first < frames.size();) {
        size_t last = first;
        while (last < frames.size() && frames[last].repeat == frames[first].repeat) ++last;
        repeats.push_back(frames.subspan(first, last - first));
        first = last;
    }
    return repeats;
}

Check check_budget(const PlayRecord& record, const Budget& budget) {
    const auto measure = std::find_if(measures().begin(), measures().end(), [&](const Measure& one) {
        return std::string_view(one.kind.name) == budget.kind.name;
    });
    std::vector<double> values;
    for (const Frames& repeat : repeats_of(record)) values.push_back(measure->value(record, repeat));
    const double worst = quantile(values, 1.0), best = quantile(values, 0.0);
    // What is judged: of times the usual repeat, of the others the worst.
    Check check{budget.kind.name, Verdict::passed,  budget.kind.is_time ? median(values) : worst,
                budget.limit,     budget.kind.unit, {}};
    if (worst <= budget.limit) return check;
    const std::string found =
        fmt::format("{:.6g} {} against a budget of {:g}", check.value, check.unit, check.limit);
    if (budget.kind.is_time && best <= budget.limit) {
        check.verdict = Verdict::inconclusive;
        check.fault = fmt::format("{}; the repeats say {:.6g} to {:.6g}: a quieter machine would tell", found,
                                  best, worst);
    } else if (budget.kind.is_time && record.others_share > k_quiet_share) {
        check.verdict = Verdict::inconclusive;
        check.fault = fmt::format("{}; but other programs had {:.0f} % of the machine: stop them", found,
                                  100.0 * record.others_share);
    } else {
        check.verdict = Verdict::failed;
        check.fault = fmt::format("{} ({})", found, budget.kind.what);
    }
    return check;
}

bool drew_the_same(const FrameReport& a, const FrameReport& b) {
    return a.triangles == b.triangles && a.lines == b.lines && a.points == b.points && a.leaves == b.leaves &&
           a.plants_visible == b.plants_visible && a.clouds == b.clouds;
}

// Nothing that is drawn may depend on time, unless the frames were told to.
void check_repeats(const PlayRecord& record, std::vector<Check>& checks) {
    const std::vector<Frames> repeats = repeats_of(record);
    const bool depends_on_time =
        record.settings.time_budget_ms > 0.0 || (record.streamed && !record.settings.wait_for_tiles);
    if (repeats.size() < 2 || depends_on_time) return;
    size_t different = 0;
    for (const Frames& repeat : repeats)
        for (size_t i = 0; i < std::min(repeat.size(), repeats.front().size()); ++i)
            different += !drew_the_same(repeat[i].report, repeats.front()[i].report);
    checks.push_back({"repeats draw the same", different ? Verdict::failed : Verdict::passed,
                      double(different), 0.0, "frames",
                      different ? "frames differ from the first repeat's in what they drew" : ""});
}

}  // namespace

const char* name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::passed:
            return "passed";
        case Verdict::failed:
            return "failed";
        case Verdict::inconclusive:
            return "inconclusive";
    }
    return "unknown";
}

std::vector<BudgetKind> budget_kinds() {
    std::vector<BudgetKind> kinds;
    for (const Measure& measure : measures()) kinds.push_back(measure.kind);
    return kinds;
}

Result<std::vector<Budget>> parse_budgets(const std::string& text) {
    std::vector<Budget> budgets;
    for (size_t first = 0; first < text.size();) {
        const size_t comma = std::min(text.find(',', first), text.size());
        const std::string piece = text.substr(first, comma - first);
        first = comma + 1;
        const size_t equals = std::min(piece.find('='), piece.size());
        const std::string name = piece.substr(0, equals);
        const std::vector<BudgetKind> kinds = budget_kinds();
        const auto kind =
            std::find_if(kinds.begin(), kinds.end(), [&](const BudgetKind& k) { return k.name == name; });
        if (kind == kinds.end()) {
            std::vector<std::string> names;
            for (const BudgetKind& known : kinds) names.emplace_back(known.name);
            return fail(ErrorId::name_unknown, "", "--budget", fmt::format("'{}' has no budget", name),
                        fmt::format("use one of: {}", fmt::join(names, ", ")));
        }
        COPPICE_TRY(const double limit,
                    parse_limit(*kind, std::string_view(piece).substr(std::min(equals + 1, piece.size()))));
        budgets.push_back({*kind, limit});
    }
    return budgets;
}

std::vector<Check> check_playthrough(const PlayRecord& record, const std::vector<Budget>& budgets) {
    std::vector<Check> checks;
    for (const Budget& budget : budgets) checks.push_back(check_budget(record, budget));
    check_repeats(record, checks);
    if (record.validation)
        checks.push_back(
            {"validation layers", record.validation_messages ? Verdict::failed : Verdict::passed,
             double(record.validation_messages), 0.0, "messages",
             record.validation_messages ? "messages of the validation layers; there must be none" : ""});
    return checks;
}

Status status_of(const std::vector<Check>& checks) {
    for (const Verdict verdict : {Verdict::failed, Verdict::inconclusive}) {
        const auto is_it = [verdict](const Check& check) { return check.verdict == verdict; };
        const auto first = std::find_if(checks.begin(), checks.end(), is_it);
        if (first == checks.end()) continue;
        return fail(
            verdict == Verdict::failed ? ErrorId::regressed : ErrorId::inconclusive, "", first->name,
            first->fault,
            fmt::format("{} of {} checks {}: see the list of checks",
                        std::count_if(checks.begin(), checks.end(), is_it), checks.size(), name_of(verdict)));
    }
    return {};
}

}  // namespace coppice
