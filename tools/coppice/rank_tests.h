// Tests of whether values differ that ask nothing of how they are spread: only their order counts. Up to k_exact_limit
// values exact: the chance is counted over all arrangements, ties share their ranks. Above, where counting would take
// minutes, by the normal distribution, with corrections for ties and for sums being whole. Two-sided.
// Source: Lehmann, Nonparametrics (1975), 1.2, 3.2.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace coppice {

// Of all values together. There the two differ by less than 0.002, and by less than a fifth of a chance of 0.001 or more; of
// rank_sum_p where the smaller share is a third or more.
inline constexpr size_t k_exact_limit = 120;

// Wilcoxon's signed rank test: the chance that signs drawn at random leave the differences as lopsided as they are, or
// more. Differences of 0 are left out. 1 where none is left.
double signed_rank_p(std::span<const double> differences);

// Mann and Whitney's test (Wilcoxon's rank sum): likewise for a share of the values of a and b drawn at random as a.
// 1 where either is empty.
double rank_sum_p(std::span<const double> a, std::span<const double> b);

// What both do below and above the limit: to hold one against the other.
double exact_signed_rank_p(std::span<const double> differences);
double normal_signed_rank_p(std::span<const double> differences);
double exact_rank_sum_p(std::span<const double> a, std::span<const double> b);
double normal_rank_sum_p(std::span<const double> a, std::span<const double> b);

// Hodges and Lehmann's estimates of the shift that belong to them: the median of the means of all pairs, and the median of
// all differences b - a. 0 without values.
double shift_of(std::span<const double> differences);
double shift_between(std::span<const double> a, std::span<const double> b);

}  // namespace coppice
