#include "tools/foliage/sweep_levels.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include "plugins/vegetation/lod/leaf_forest.h"
#include "plugins/vegetation/lod/leaf_lifetimes.h"
#include "plugins/vegetation/lod/view_dependent_foliage.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

void copy_words(std::span<const uint32_t> words, std::span<uint32_t> target, size_t first) {
    std::memcpy(target.data() + first, words.data(), words.size_bytes());
}

class Baseline {
  public:
    Baseline(uint32_t leaf_count, std::span<const LeafCollapse> collapses)
        : foliage_(grow_view_dependent_foliage(leaf_count, collapses)) {}
    ChangeCost change_to(uint32_t level, std::span<uint32_t> target) {
        Stopwatch extracting;
        extract_leaves(foliage_, level, leaves_);
        const double extract_ms = extracting.ms();
        Stopwatch copying;
        copy_words(leaves_, target, 0);
        return {extract_ms, copying.ms(), leaves_.size() * sizeof(uint32_t)};
    }

  private:
    ViewDependentFoliage foliage_;
    std::vector<uint32_t> leaves_;
};

// Each cluster has its place in the target, its number of leaves first.
class Clusters {
  public:
    Clusters(uint32_t leaf_count, std::span<const LeafCollapse> collapses)
        : forest_(grow_leaf_forest(leaf_count, collapses)), level_(forest_), words_(sweep_words(leaf_count)) {
        for (uint32_t c = 0; c < forest_.cluster_count(); ++c) {
            place_.push_back(next_place_);
            next_place_ += 1 + forest_.capacity(c);
        }
    }
    void restart() { level_.move_to(0); }
    ChangeCost change_to(uint32_t level, std::span<uint32_t> target) {
        Stopwatch extracting;
        const std::span<const uint32_t> changed = level_.move_to(level);
        uint32_t* end = words_.data();
        for (uint32_t c : changed) {
            *end = level_.active_count(c);
            end = level_.list_active(c, end + 1);
        }
        const double extract_ms = extracting.ms();
        Stopwatch copying;
        const uint32_t* from = words_.data();
        for (uint32_t c : changed) {
            copy_words({from, size_t(*from) + 1}, target, place_[c]);
            from += *from + 1;
        }
        return {extract_ms, copying.ms(), size_t(end - words_.data()) * sizeof(uint32_t)};
    }

  private:
    LeafForest forest_;
    ForestLevel level_;
    std::vector<uint32_t> words_;
    std::vector<size_t> place_;
    size_t next_place_ = 0;
};

class AllLevels {
  public:
    AllLevels(uint32_t leaf_count, std::span<const LeafCollapse> collapses)
        : lifetimes_(order_by_removal(leaf_count, collapses)) {}
    ChangeCost change_to(uint32_t level, std::span<uint32_t> target) const {
        Stopwatch copying;
        // A store that is not optimised away: mapped memory is somebody else's, too.
        *static_cast<volatile uint32_t*>(target.data()) = level;
        return {0.0, copying.ms(), sizeof(uint32_t)};
    }
    double scan_ms(uint32_t level, std::span<uint32_t> target) const {
        Stopwatch scanning;
        uint32_t* end = target.data();
        for (uint32_t leaf : lifetimes_.candidates(level))
            if (lifetimes_.is_born(leaf, level)) *end++ = leaf;
        return scanning.ms();
    }
    uint32_t candidate_count(uint32_t level) const { return uint32_t(lifetimes_.candidates(level).size()); }

  private:
    LeafLifetimes lifetimes_;
};

struct StepTimes {
    std::array<std::vector<double>, k_structure_count> extract_ms, copy_ms;
    std::vector<double> scan_ms;
};

}  // namespace

// Clusters hold a leaf each at least.
size_t sweep_words(uint32_t leaf_count) { return 2 * size_t(leaf_count) + 1; }

std::vector<SweepStep> sweep_levels(uint32_t leaf_count, std::span<const LeafCollapse> collapses,
                                    std::span<uint32_t> target, const SweepSettings& settings) {
    assert(target.size() >= sweep_words(leaf_count) && settings.round_count > 0);
    const uint32_t collapse_count = uint32_t(collapses.size());
    const uint32_t step_count = std::min(settings.step_count, collapse_count);
    std::vector<SweepStep> steps(step_count);
    std::vector<StepTimes> times(step_count);
    Baseline baseline(leaf_count, collapses);
    Clusters clusters(leaf_count, collapses);
    const AllLevels all_levels(leaf_count, collapses);
    for (uint32_t round = 0; round <= settings.round_count; ++round) {
        clusters.restart();
        for (uint32_t i = 0; i < step_count; ++i) {
            const uint32_t level = uint32_t(uint64_t(collapse_count) * (i + 1) / step_count);
            SweepStep& step = steps[i];
            step.leaf_count = leaf_count - level;
            step.change = {baseline.change_to(level, target), clusters.change_to(level, target),
                           all_levels.change_to(level, target)};
            step.scan_ms = all_levels.scan_ms(level, target);
            step.candidate_count = all_levels.candidate_count(level);
            if (round == 0) continue;
            for (size_t s = 0; s < k_structure_count; ++s) {
                times[i].extract_ms[s].push_back(step.change[s].extract_ms);
                times[i].copy_ms[s].push_back(step.change[s].copy_ms);
            }
            times[i].scan_ms.push_back(step.scan_ms);
        }
    }
    for (uint32_t i = 0; i < step_count; ++i) {
        for (size_t s = 0; s < k_structure_count; ++s) {
            steps[i].change[s].extract_ms = median(times[i].extract_ms[s]);
            steps[i].change[s].copy_ms = median(times[i].copy_ms[s]);
        }
        steps[i].scan_ms = median(times[i].scan_ms);
    }
    return steps;
}

SweepSum sum_of(std::span<const SweepStep> steps, FoliageStructure structure) {
    SweepSum sum;
    for (const SweepStep& step : steps) {
        const ChangeCost& cost = step.change[size_t(structure)];
        sum.extract_ms += cost.extract_ms;
        sum.change_ms += cost.extract_ms + cost.copy_ms;
        sum.bytes += double(cost.bytes);
    }
    return sum;
}

}  // namespace coppice
