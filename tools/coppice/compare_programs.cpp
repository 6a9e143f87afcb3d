#include "tools/coppice/compare_programs.h"

#include <array>
#include <cmath>
#include <memory>
#include <fmt/format.h>
#include "runtime/core/progress.h"
#include "tools/coppice/lockstep_program.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

enum Flier : size_t { k_base, k_new, k_again, k_fliers };

struct Flown {
    std::vector<double> new_over_base, again_over_base;  // logarithms, of blocks
    std::array<std::vector<double>, k_fliers> ms;
    std::array<std::map<std::string, double>, k_fliers> counts;  // sums
};

// Which of the two failed. A base that fails leaves nothing to compare with: bad input, no verdict on the new one.
Error error_of(Flier flier, Error error) {
    error.place = flier == k_new ? "new" : "base";
    if (flier != k_new && error.id == ErrorId::regressed) error.id = ErrorId::usage;
    return error;
}

using Fliers = std::array<std::unique_ptr<LockstepProgram>, k_fliers>;

Result<Fliers> start_fliers(const ProgramsToCompare& programs) {
    Fliers fliers;
    for (const Flier flier : {k_base, k_new, k_again}) {
        auto started =
            LockstepProgram::start(flier == k_new ? programs.changed : programs.base, programs.arguments);
        if (!started) return fail(error_of(flier, std::move(started.error())));
        fliers[flier] = std::move(*started);
    }
    return fliers;
}

// No program draws twice in a row, since what it left in the caches would help it.
Status fly_block(const ProgramsToCompare& programs, Fliers& fliers, uint32_t first_frame, Flown& flown) {
    static constexpr std::array<Flier, k_fliers> k_forward{k_base, k_new, k_again},
        k_backward{k_new, k_base, k_again};
    std::vector<double> new_over_base, again_over_base;
    for (uint32_t i = 0; i < k_block_frames; ++i) {
        const uint32_t frame = (first_frame + i) % fliers[k_base]->frame_count();
        std::array<double, k_fliers> ms{};
        for (const Flier flier : i < k_block_frames / 2 ? k_forward : k_backward) {
            const auto drawn = fliers[flier]->draw(frame, flier == k_new ? programs.slower : 0.0);
            if (!drawn) return fail(error_of(flier, drawn.error()));
            ms[flier] = std::max(drawn->ms, 1e-6);
            flown.ms[flier].push_back(drawn->ms);
            for (const auto& [name, count] : drawn->counts) flown.counts[flier][name] += count;
        }
        new_over_base.push_back(std::log(ms[k_new]) - 0.5 * (std::log(ms[k_base]) + std::log(ms[k_again])));
        again_over_base.push_back(std::log(ms[k_again] / ms[k_base]));
    }
    flown.new_over_base.push_back(median(new_over_base));
    flown.again_over_base.push_back(median(again_over_base));
    return {};
}

Status fly_rounds(const ProgramsToCompare& programs, Flown& flown) {
    Progress progress("comparing", k_rounds);
    for (uint32_t round = 0; round < k_rounds; ++round) {
        COPPICE_TRY(Fliers fliers, start_fliers(programs));
        if (fliers[k_new]->frame_count() != fliers[k_base]->frame_count())
            return fail(ErrorId::usage, programs.changed, "", "flies a path of another length",
                        "the same scene for both");
        const Stopwatch clock;
        // Blocks are spread over the path.
        for (uint32_t block = 0; clock.ms() < programs.seconds * 1e3 / k_rounds; ++block)
            COPPICE_CHECK(fly_block(programs, fliers, (round + block * k_rounds) * k_block_frames, flown));
        progress.advance();
    }
    return {};
}

Comparison judge(const Flown& flown, double floor_share) {
    Comparison comparison;
    comparison.samples = flown.new_over_base.size();
    comparison.base_ms = median(flown.ms[k_base]);
    comparison.new_ms = median(flown.ms[k_new]);
    comparison.effect = effect_of_pairs(flown.new_over_base);
    comparison.itself = effect_of_pairs(flown.again_over_base);
    comparison.floor_share = floor_share;
    auto means = flown.counts;
    for (auto& counts : means)
        for (auto& [name, count] : counts) count /= double(comparison.samples * k_block_frames);
    comparison.counts = compare_counts(means[k_base], means[k_again], means[k_new], floor_share);
    return comparison;
}

}  // namespace

Result<Comparison> compare_programs(const ProgramsToCompare& programs) {
    Flown flown;
    Comparison comparison;
    for (uint32_t attempt = 0; attempt < k_most_attempts; ++attempt) {
        COPPICE_CHECK(fly_rounds(programs, flown));
        if (const size_t pairs = flown.new_over_base.size(); pairs < k_least_pairs)
            return fail(
                ErrorId::usage, "", "--seconds", fmt::format("enough for {} blocks of frames only", pairs),
                fmt::format("{:.0f} seconds, or a smaller --headless",
                            std::ceil(programs.seconds * double(k_least_pairs) / double(pairs) * 1.2)));
        comparison = judge(flown, programs.floor_share);
        if (speed_of(comparison) != Speed::inconclusive) break;
    }
    return comparison;
}

}  // namespace coppice
