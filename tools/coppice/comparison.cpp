#include "tools/coppice/comparison.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include "tools/coppice/rank_tests.h"

namespace coppice {

const char* name_of(Speed speed) {
    switch (speed) {
        case Speed::same:
            return "same";
        case Speed::faster:
            return "faster";
        case Speed::slower:
            return "slower";
        case Speed::inconclusive:
            return "inconclusive";
    }
    return "unknown";
}

bool is_difference(const Effect& effect, double floor_share) {
    return effect.chance < k_chance && std::fabs(effect.share) >= floor_share;
}

Effect effect_of_pairs(std::span<const double> log_ratios) {
    return {std::exp(shift_of(log_ratios)) - 1.0, signed_rank_p(log_ratios)};
}

Effect effect_of_times(std::span<const double> base_ms, std::span<const double> new_ms) {
    std::vector<double> base, changed;
    for (const double ms : base_ms) base.push_back(std::log(std::max(ms, 1e-9)));
    for (const double ms : new_ms) changed.push_back(std::log(std::max(ms, 1e-9)));
    return {std::exp(shift_between(base, changed)) - 1.0, rank_sum_p(base, changed)};
}

std::vector<CountChange> compare_counts(const std::map<std::string, double>& base,
                                        const std::map<std::string, double>& again,
                                        const std::map<std::string, double>& changed, double floor_share) {
    std::vector<CountChange> changes;
    for (const auto& [name, value] : changed) {
        const auto before = base.find(name);
        if (before == base.end() || before->second == value)
            continue;  // one that base does not know is no change
        const auto repeated = again.find(name);
        const double varied = repeated == again.end() ? 0.0 : std::fabs(repeated->second - before->second);
        changes.push_back(
            {name, before->second, value, value > before->second * (1.0 + floor_share) + 2.0 * varied});
    }
    return changes;
}

Speed speed_of(const Comparison& comparison) {
    if (!comparison.same_machine || is_difference(comparison.itself, comparison.floor_share))
        return Speed::inconclusive;
    if (std::fabs(comparison.effect.share) < comparison.floor_share) return Speed::same;
    if (!is_difference(comparison.effect, comparison.floor_share)) return Speed::inconclusive;
    return comparison.effect.share > 0.0 ? Speed::slower : Speed::faster;
}

nlohmann::json to_json(const Comparison& comparison) {
    nlohmann::json counts = nlohmann::json::array();
    for (const CountChange& change : comparison.counts)
        counts.push_back(
            {{"name", change.name}, {"base", change.base}, {"new", change.changed}, {"grew", change.grew}});
    auto effect = [](const Effect& one) {
        return nlohmann::json{{"share", one.share}, {"chance", one.chance}};
    };
    return {{"verdict", name_of(speed_of(comparison))},
            {"base_ms", comparison.base_ms},
            {"new_ms", comparison.new_ms},
            {"effect", effect(comparison.effect)},
            {"base_against_itself", effect(comparison.itself)},
            {"samples", comparison.samples},
            {"floor_share", comparison.floor_share},
            {"same_machine", comparison.same_machine},
            {"counts", std::move(counts)}};
}

std::string describe(const Comparison& comparison) {
    auto line = [](const char* name, const Effect& effect) {
        return fmt::format("  {:<22}{:+7.2f} % of time, chance {:.2g}\n", name, 100.0 * effect.share,
                           effect.chance);
    };
    std::string text = fmt::format("{}: {:.2f} ms a frame, before {:.2f} ms ({} samples, floor {:g} %)\n",
                                   name_of(speed_of(comparison)), comparison.new_ms, comparison.base_ms,
                                   comparison.samples, 100.0 * comparison.floor_share);
    text += line("new against base", comparison.effect) + line("base against itself", comparison.itself);
    if (!comparison.same_machine)
        text += "  flown on two machines or drivers: times say nothing, counts do\n";
    for (const CountChange& change : comparison.counts)
        text += fmt::format("  {:<22}{:.6g}, before {:.6g}{}\n", change.name, change.changed, change.base,
                            change.grew ? "  GREW" : "");
    return text;
}

Status status_of(const Comparison& comparison) {
    for (const CountChange& change : comparison.counts)
        if (change.grew)
            return fail(ErrorId::regressed, "", change.name,
                        fmt::format("{:.6g} in place of {:.6g}", change.changed, change.base),
                        fmt::format("at most {:g} % more", 100.0 * comparison.floor_share));
    switch (speed_of(comparison)) {
        case Speed::slower:
            return fail(ErrorId::regressed, "", "time of a frame",
                        fmt::format("{:.2f} % slower", 100.0 * comparison.effect.share),
                        fmt::format("less than {:g} %", 100.0 * comparison.floor_share));
        case Speed::inconclusive:
            return fail(ErrorId::inconclusive, "", "time of a frame",
                        comparison.same_machine
                            ? fmt::format("{:+.2f} %, by a chance of {:.2g}; base against itself {:+.2f} %",
                                          100.0 * comparison.effect.share, comparison.effect.chance,
                                          100.0 * comparison.itself.share)
                            : std::string("flown on two machines or drivers"),
                        "compare on one machine with nothing else to do");
        default:
            return {};
    }
}

}  // namespace coppice
