#include "tools/coppice/bench_compare.h"

#include <fmt/format.h>
#include "runtime/core/file.h"
#include "tools/coppice/compare_programs.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

constexpr double k_slower = 0.1, k_found_share = 0.95, k_passed_share = 0.99, k_limit_s = 300.0;

struct Tally {
    uint32_t right = 0, inconclusive = 0;
    std::vector<double> shares, seconds;
};

Status add_comparison(const ProgramsToCompare& programs, Speed right, Tally& tally) {
    const Stopwatch clock;
    COPPICE_TRY(const Comparison comparison, compare_programs(programs));
    tally.seconds.push_back(clock.ms() * 1e-3);
    const Speed speed = speed_of(comparison);
    tally.right += speed == right;
    tally.inconclusive += speed == Speed::inconclusive;
    tally.shares.push_back(100.0 * comparison.effect.share);
    fmt::print("  {:.0f} % put in: {:+.2f} % found, base against itself {:+.2f} %: {}\n",
               100.0 * programs.slower, 100.0 * comparison.effect.share, 100.0 * comparison.itself.share,
               name_of(speed));
    std::fflush(stdout);
    return {};
}

}  // namespace

Result<nlohmann::json> bench_compare(const BenchSettings& settings) {
    ProgramsToCompare programs;
    programs.base = programs.changed = program_dir() + "/coppice";
    programs.arguments = {
        settings.scene.empty() ? settings.content + "/scenes/pines.eco.json" : settings.scene, "--headless",
        "480x320"};
    if (!settings.device.empty())
        programs.arguments.insert(programs.arguments.end(), {"--device", settings.device});
    if (!settings.cache_dir.empty())
        programs.arguments.insert(programs.arguments.end(), {"--cache", settings.cache_dir});
    ProgramsToCompare slowed = programs;
    slowed.slower = k_slower;
    Tally found, passed;
    for (uint32_t i = 0; i < settings.comparisons; ++i) {
        COPPICE_CHECK(add_comparison(slowed, Speed::slower, found));
        COPPICE_CHECK(add_comparison(programs, Speed::same, passed));
    }
    const double count = settings.comparisons;
    fmt::print("slowdown of {:.0f} % found in {} of {}, itself passed in {} of {}\n", 100.0 * k_slower,
               found.right, settings.comparisons, passed.right, settings.comparisons);
    std::vector<double> seconds = found.seconds;
    seconds.insert(seconds.end(), passed.seconds.begin(), passed.seconds.end());
    nlohmann::json figures = nlohmann::json::array();
    for (const Figure& figure : std::vector<Figure>{
             {"slowdown of 10 % found", found.right / count, "share", k_found_share},
             {"against itself passed", passed.right / count, "share", k_passed_share},
             {"comparisons of each kind", count, "", {}},
             {"inconclusive, of both kinds", double(found.inconclusive + passed.inconclusive), "", {}},
             {"effect of the slowdown, median", median(found.shares), "%", {}},
             {"effect against itself, smallest", quantile(passed.shares, 0.0), "%", {}},
             {"effect against itself, largest", quantile(passed.shares, 1.0), "%", {}},
             {"one comparison, longest", quantile(seconds, 1.0), "s", k_limit_s, Reach::at_most}})
        figures.push_back(to_json(figure));
    return nlohmann::json{{"name", "compare"}, {"figures", std::move(figures)}};
}

}  // namespace coppice
