#include "tools/coppice/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include "tools/coppice/statistics.h"

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

}  // namespace

double signed_rank_p(std::span<const double> differences) {
    std::vector<double> sizes, signs;
    for (const double difference : differences) {
        if (difference == 0.0) continue;
        sizes.push_back(std::fabs(difference));
        signs.push_back(difference);
    }
    if (sizes.empty()) return 1.0;
    const std::vector<size_t> ranks = doubled_ranks(sizes);
    const size_t most = std::accumulate(ranks.begin(), ranks.end(), size_t(0));
    std::vector<double> chance(most + 1, 0.0);
    chance[0] = 1.0;
    size_t positive = 0, reached = 0;
    for (size_t i = 0; i < ranks.size(); ++i) {
        if (signs[i] > 0.0) positive += ranks[i];
        reached += ranks[i];
        for (size_t s = reached + 1; s-- > 0;)
            chance[s] = 0.5 * (chance[s] + (s >= ranks[i] ? chance[s - ranks[i]] : 0.0));
    }
    return two_sided(chance, positive, 0.5 * double(most));
}

double rank_sum_p(std::span<const double> a, std::span<const double> b) {
    if (a.empty() || b.empty()) return 1.0;
    std::vector<double> all(a.begin(), a.end());
    all.insert(all.end(), b.begin(), b.end());
    const std::vector<size_t> ranks = doubled_ranks(all);
    const size_t most = std::accumulate(ranks.begin(), ranks.end(), size_t(0));
    // ways[k][s]: choices of k of the values whose ranks have the sum s.
    std::vector<std::vector<double>> ways(a.size() + 1, std::vector<double>(most + 1, 0.0));
    ways[0][0] = 1.0;
    for (const size_t rank : ranks)
        for (size_t k = a.size(); k > 0; --k)
            for (size_t s = most + 1; s-- > rank;) ways[k][s] += ways[k - 1][s - rank];
    std::vector<double> chance = ways[a.size()];
    const double total = std::accumulate(chance.begin(), chance.end(), 0.0);
    for (double& one : chance) one /= total;
    const size_t sum = std::accumulate(ranks.begin(), ranks.begin() + long(a.size()), size_t(0));
    return two_sided(chance, sum, double(a.size()) * double(all.size() + 1));
}

double shift_of(std::span<const double> differences) {
    std::vector<double> means;
    for (size_t i = 0; i < differences.size(); ++i)
        for (size_t k = i; k < differences.size(); ++k)
            means.push_back(0.5 * (differences[i] + differences[k]));
    return median(std::move(means));
}

double shift_between(std::span<const double> a, std::span<const double> b) {
    std::vector<double> differences;
    for (const double one : a)
        for (const double other : b) differences.push_back(other - one);
    return median(std::move(differences));
}

}  // namespace coppice
