#include "tools/coppice/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace coppice {
namespace {

// Twice the rank of each value, from 2 on, so that the mean rank of ties is whole.
std::vector<size_t> doubled_ranks(const std::vector<double>& values) {
    std::vector<size_t> order(values.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
    std::vector<size_t> ranks(values.size());
    for (size_t first = 0; first < order.size();) {
        size_t last = first;
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        for (size_t i = first; i < last; ++i) ranks[order[i]] = first + 1 + last;
        first = last;
    }
    return ranks;
}

// Chance of a sum as far from the mean as `sum`, or farther, on either side.
double two_sided(const std::vector<double>& chance_of_sum, size_t sum, double mean) {
    const double far = std::fabs(double(sum) - mean) - 1e-9;
    double p = 0.0;
    for (size_t s = 0; s < chance_of_sum.size(); ++s)
        if (std::fabs(double(s) - mean) >= far) p += chance_of_sum[s];
    return std::min(p, 1.0);
}

// Chance of being so far from the mean, or farther, where `step` is between two sums that there are: a sum stands for half of
// it on either side.
double normal_two_sided(double sum, double mean, double variance, double step) {
    const double far = std::fabs(sum - mean) - 0.5 * step;
    return far <= 0.0 || variance <= 0.0 ? 1.0 : std::erfc(far / std::sqrt(2.0 * variance));
}

constexpr double k_step = 2.0;  // of sums of doubled ranks

// Of differences that are not 0.
struct SignedRanks {
    std::vector<size_t> ranks;  // doubled, of their sizes
    size_t positive = 0, most = 0;
    explicit SignedRanks(std::span<const double> differences) {
        std::vector<double> sizes, signs;
        for (const double difference : differences) {
            if (difference == 0.0) continue;
            sizes.push_back(std::fabs(difference));
            signs.push_back(difference);
        }
        ranks = doubled_ranks(sizes);
        for (size_t i = 0; i < ranks.size(); ++i) {
            most += ranks[i];
            if (signs[i] > 0.0) positive += ranks[i];
        }
    }
};

std::vector<size_t> ranks_of_both(std::span<const double> a, std::span<const double> b) {
    std::vector<double> all(a.begin(), a.end());
    all.insert(all.end(), b.begin(), b.end());
    return doubled_ranks(all);
}

size_t sum_of_first(const std::vector<size_t>& ranks, size_t count) {
    return std::accumulate(ranks.begin(), ranks.begin() + long(count), size_t(0));
}

// The median of so many values of which one only knows how many are at most x, all of them in [low, high]. No list of them is
// needed, which would not fit where they are pairs.
template <class CountUpTo>
double median_by_counting(double low, double high, size_t count, const CountUpTo& count_up_to) {
    auto value_of_rank = [&](size_t rank) {
        if (count_up_to(low) > rank) return low;
        double below = low, reached = high;
        for (;;) {
            const double middle = below + 0.5 * (reached - below);
            if (middle <= below || middle >= reached) return reached;
            (count_up_to(middle) > rank ? reached : below) = middle;
        }
    };
    const double lower = value_of_rank((count - 1) / 2);
    return count % 2 ? lower : lower + 0.5 * (value_of_rank(count / 2) - lower);
}

std::vector<double> sorted(std::span<const double> values) {
    std::vector<double> in_order(values.begin(), values.end());
    std::sort(in_order.begin(), in_order.end());
    return in_order;
}

}  // namespace

double exact_signed_rank_p(std::span<const double> differences) {
    const SignedRanks of(differences);
    std::vector<double> chance(of.most + 1, 0.0);
    chance[0] = 1.0;
    size_t reached = 0;
    for (const size_t rank : of.ranks) {
        reached += rank;
        for (size_t s = reached + 1; s-- > 0;)
            chance[s] = 0.5 * (chance[s] + (s >= rank ? chance[s - rank] : 0.0));
    }
    return two_sided(chance, of.positive, 0.5 * double(of.most));
}

double normal_signed_rank_p(std::span<const double> differences) {
    const SignedRanks of(differences);
    double variance = 0.0;
    for (const size_t rank : of.ranks) variance += 0.25 * double(rank) * double(rank);
    return normal_two_sided(double(of.positive), 0.5 * double(of.most), variance, k_step);
}

double signed_rank_p(std::span<const double> differences) {
    return differences.size() <= k_exact_limit ? exact_signed_rank_p(differences)
                                               : normal_signed_rank_p(differences);
}

double exact_rank_sum_p(std::span<const double> a, std::span<const double> b) {
    if (a.empty() || b.empty()) return 1.0;
    const std::vector<size_t> ranks = ranks_of_both(a, b);
    const size_t most = sum_of_first(ranks, ranks.size());
    // ways[k][s]: choices of k of the values whose ranks have the sum s.
    std::vector<std::vector<double>> ways(a.size() + 1, std::vector<double>(most + 1, 0.0));
    ways[0][0] = 1.0;
    size_t reached = 0;
    for (const size_t rank : ranks) {
        reached += rank;
        for (size_t k = a.size(); k > 0; --k)
            for (size_t s = reached + 1; s-- > rank;) ways[k][s] += ways[k - 1][s - rank];
    }
    std::vector<double> chance = ways[a.size()];
    const double total = std::accumulate(chance.begin(), chance.end(), 0.0);
    for (double& one : chance) one /= total;
    return two_sided(chance, sum_of_first(ranks, a.size()), double(a.size()) * double(ranks.size() + 1));
}

double normal_rank_sum_p(std::span<const double> a, std::span<const double> b) {
    if (a.empty() || b.empty()) return 1.0;
    const std::vector<size_t> ranks = ranks_of_both(a, b);
    const double count = double(ranks.size()), mean_rank = count + 1.0;
    double squares = 0.0;
    for (const size_t rank : ranks) squares += (double(rank) - mean_rank) * (double(rank) - mean_rank);
    const double variance = double(a.size()) * double(b.size()) / (count * (count - 1.0)) * squares;
    return normal_two_sided(double(sum_of_first(ranks, a.size())), double(a.size()) * mean_rank, variance,
                            k_step);
}

double rank_sum_p(std::span<const double> a, std::span<const double> b) {
    return a.size() + b.size() <= k_exact_limit ? exact_rank_sum_p(a, b) : normal_rank_sum_p(a, b);
}

double shift_of(std::span<const double> differences) {
    if (differences.empty()) return 0.0;
    const std::vector<double> d = sorted(differences);
    return median_by_counting(d.front(), d.back(), d.size() * (d.size() + 1) / 2, [&](double most) {
        size_t count = 0, end = d.size();  // [i, end) are the partners of i
        for (size_t i = 0; i < d.size(); ++i) {
            while (end > i && 0.5 * (d[i] + d[end - 1]) > most) --end;
            if (end <= i) break;
            count += end - i;
        }
        return count;
    });
}

double shift_between(std::span<const double> a, std::span<const double> b) {
    if (a.empty() || b.empty()) return 0.0;
    const std::vector<double> from = sorted(a), to = sorted(b);
    return median_by_counting(to.front() - from.back(), to.back() - from.front(), a.size() * b.size(),
                              [&](double most) {
                                  size_t count = 0, end = 0;  // [0, end) of `to`, larger for larger `from`
                                  for (const double one : from) {
                                      while (end < to.size() && to[end] - one <= most) ++end;
                                      count += end;
                                  }
                                  return count;
                              });
}

}  // namespace coppice
