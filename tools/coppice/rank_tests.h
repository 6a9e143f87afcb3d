// Tests of whether values differ that ask nothing of how they are spread: only their order counts. Exact: the chance is
// counted over all arrangements, ties share their ranks. Two-sided.
#pragma once
#include <span>
#include <vector>

namespace coppice {

// Wilcoxon's signed rank test: the chance that signs drawn at random leave the differences as lopsided as they are, or
// more. Differences of 0 are left out. 1 where none is left. At most a few hundred.
double signed_rank_p(std::span<const double> differences);

// Mann and Whitney's test (Wilcoxon's rank sum): likewise for a share of the values of a and b drawn at random as a.
// 1 where either is empty. At most some fifty each.
double rank_sum_p(std::span<const double> a, std::span<const double> b);

// Hodges and Lehmann's estimates of the shift that belong to them: the median of the means of all pairs, and the median of
// all differences b - a. 0 without values.
double shift_of(std::span<const double> differences);
double shift_between(std::span<const double> a, std::span<const double> b);

}  // namespace coppice
