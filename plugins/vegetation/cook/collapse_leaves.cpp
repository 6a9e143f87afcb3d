#include "plugins/vegetation/cook/collapse_leaves.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include "plugins/vegetation/cook/join_leaves.h"
#include "plugins/vegetation/cook/keep_light.h"
#include "plugins/vegetation/cook/nearest_leaves.h"
#include "plugins/vegetation/cook/steer_coverage.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr uint32_t k_none = UINT32_MAX;

class Collapser {
  public:
    Collapser(std::span<const Leaf> crown, const LeafCollapseSettings& settings)
        : crown_(crown),
          settings_(settings),
          leaf_limit_(uint32_t(2 * crown.size())),
          nearest_(first_entries(crown), leaf_limit_),
          built_size_(uint32_t(crown.size())),
          pairs_(leaf_limit_),
          gone_(leaf_limit_, false),
          steering_(crown, settings.least_area) {
        leaves_.reserve(leaf_limit_);
        raw_.reserve(leaf_limit_);
        for (uint32_t i = 0; i < crown.size(); ++i) {
            leaves_.push_back(measure_leaf(crown[i]));
            raw_.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
        }
    }

    std::vector<LeafCollapse> run() {
        const uint32_t target_count = std::max(settings_.target_count, 1u);
        parallel_for(crown_.size(), 256, [this](size_t first, size_t last) {
            std::vector<NearestLeaves::Neighbor> neighbors;
            for (size_t i = first; i < last; ++i) pairs_[i] = find_partner(uint32_t(i), neighbors);
        });
        for (uint32_t i = 0; i < crown_.size(); ++i) push(i);
        while (!queue_.empty() && nearest_.size() > target_count) {
            const auto [error_m, first, second] = queue_.top();
            queue_.pop();
            if (gone_[first] || pairs_[first].error_m != error_m || pairs_[first].partner != second) continue;
            if (gone_[second]) {
                // Whoever comes near tells its neighbours, so a lost partner's successor is hardly better, and can wait.
                pairs_[first] = find_partner(first, neighbors_);
                push(first);
                continue;
            }
            if (error_m > settings_.max_error_m) break;
            collapse(std::min(first, second), std::max(first, second), error_m);
            if (steering_.is_due(nearest_.size())) steering_.steer(leaves_there());
        }
        return std::move(collapses_);
    }

  private:
    struct Pair {
        float error_m = INFINITY;
        uint32_t partner = k_none;
    };
    struct Queued {
        float error_m;
        uint32_t leaf, partner;
        // std::priority_queue has the greatest on top.
        bool operator<(const Queued& other) const {
            return std::tie(error_m, leaf, partner) > std::tie(other.error_m, other.leaf, other.partner);
        }
    };

    static std::vector<NearestLeaves::Entry> first_entries(std::span<const Leaf> crown) {
        std::vector<NearestLeaves::Entry> entries;
        for (uint32_t i = 0; i < crown.size(); ++i) entries.push_back({measure_leaf(crown[i]).middle, i});
        return entries;
    }

    Pair find_partner(uint32_t leaf, std::vector<NearestLeaves::Neighbor>& neighbors) const {
        nearest_.find(leaves_[leaf].middle, leaf, std::max(settings_.neighbor_count, 1u), neighbors);
        Pair best;
        for (const NearestLeaves::Neighbor& n : neighbors) consider(leaf, n.leaf, best);
        return best;
    }
    void consider(uint32_t leaf, uint32_t other, Pair& best) const {
        // What is as good as the best is looked at in full, so that the lower number wins.
        const float enough = std::nextafter(best.error_m, INFINITY);
        const float error_m = leaf_error_m(leaves_[leaf], leaves_[other], settings_.weights, enough);
        if (std::tie(error_m, other) < std::tie(best.error_m, best.partner)) best = {error_m, other};
    }
    void push(uint32_t leaf) {
        if (pairs_[leaf].partner != k_none) queue_.push({pairs_[leaf].error_m, leaf, pairs_[leaf].partner});
    }

    std::vector<Leaf> leaves_there() const {
        std::vector<Leaf> there;
        for (const NearestLeaves::Entry& e : nearest_.entries()) there.push_back(leaves_[e.leaf].leaf);
        return there;
    }
    std::array<vec3, 4> raw_corners(uint32_t leaf) const {
        std::array<vec3, 4> corners;
        for (size_t k = 0; k < 4; ++k)
            corners[k] = crown_[raw_[leaf][k] / 4].corners_plant[raw_[leaf][k] % 4];
        return corners;
    }

    void collapse(uint32_t first, uint32_t second, float error_m) {
        const MeasuredLeaf& a = leaves_[first];
        const MeasuredLeaf& b = leaves_[second];
        const JoinedLeaf joined =
            join_leaves(a, b, raw_corners(first), raw_corners(second), steering_.wish());
        LeafCollapse made{{first, second}, {}, joined.growth, error_m, {}, {}};
        if (!collapses_.empty()) made.error_m = std::max(error_m, collapses_.back().error_m);
        for (size_t k = 0; k < 4; ++k)
            made.corners[k] = raw_[joined.corners[k] < 4 ? first : second][joined.corners[k] % 4];
        const double area_m2 = a.area_m2 + b.area_m2;
        const float share = area_m2 > 0.0 ? float(a.area_m2 / area_m2) : 0.5f;
        made.normal_plant = light_.choose_normal(a, b);
        made.color_linear = a.leaf.color_linear * share + b.leaf.color_linear * (1.0f - share);
        collapses_.push_back(made);

        const uint32_t leaf = uint32_t(leaves_.size());
        MeasuredLeaf measured = measure_leaf(collapsed_leaf(crown_, made));
        measured.area_m2 = area_m2;
        for (size_t k = 0; k < 6; ++k) measured.spread[k] = a.spread[k] + b.spread[k];
        leaves_.push_back(measured);
        raw_.push_back(made.corners);
        gone_[first] = gone_[second] = true;
        nearest_.remove(first);
        nearest_.replace(second, {leaves_[leaf].middle, leaf});
        if (nearest_.size() * 2 <= built_size_) {
            built_size_ = nearest_.size();
            nearest_ = NearestLeaves(nearest_.entries(), leaf_limit_);
        }
        pairs_[leaf] = find_partner(leaf, neighbors_);
        push(leaf);
        for (const NearestLeaves::Neighbor& n : neighbors_) {
            const Pair before = pairs_[n.leaf];
            consider(n.leaf, leaf, pairs_[n.leaf]);
            if (pairs_[n.leaf].partner != before.partner) push(n.leaf);
        }
    }

    std::span<const Leaf> crown_;
    const LeafCollapseSettings& settings_;
    uint32_t leaf_limit_;
    NearestLeaves nearest_;
    uint32_t built_size_;
    std::vector<MeasuredLeaf> leaves_;
    std::vector<std::array<uint32_t, 4>> raw_;  // corners before growth
    std::vector<Pair> pairs_;                   // of each leaf the neighbour with the least error
    std::vector<bool> gone_;
    std::priority_queue<Queued> queue_;
    std::vector<NearestLeaves::Neighbor> neighbors_;
    std::vector<LeafCollapse> collapses_;
    CoverageSteering steering_;
    LightKeeper light_;
};

}  // namespace

std::vector<LeafCollapse> collapse_leaves(std::span<const Leaf> crown, const LeafCollapseSettings& settings) {
    if (crown.empty()) return {};
    return Collapser(crown, settings).run();
}

}  // namespace coppice
