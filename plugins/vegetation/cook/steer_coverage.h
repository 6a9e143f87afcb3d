// Keeps a crown's coverage while its leaves are joined. Leaves that are far from each other hide each other by chance, near ones
// because they sit on one twig; joined, near ones no longer do, and a crown of the same area covers up to a tenth more at a
// twentieth of the leaves. So from time to time coverage is counted, and the leaves made next are bent, and turned, by as much
// as it is off: a proportional and integral control. Where bending is not enough, because twigs of a hundred leaves hide most of
// them, area gives way. Ours, in place of ERRATA 12's law, in which it is the first to.
#pragma once
#include <vector>
#include "plugins/vegetation/cook/join_leaves.h"
#include "plugins/vegetation/cook/leaf_coverage.h"

namespace coppice {

class CoverageSteering {
  public:
    CoverageSteering(std::span<const Leaf> crown, float least_area);

    bool is_due(size_t leaf_count) const { return double(leaf_count) <= next_count_; }
    // leaves: those there now.
    void steer(std::span<const Leaf> leaves);
    const JoinWish& wish() const { return wish_; }

  private:
    LeafCoverage coverage_;
    float least_area_;
    double next_count_;
    CoverageExcess sum_;
    JoinWish wish_;
};

}  // namespace coppice
