// Order statistics of measured times.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace coppice {

// The value below which a share of all values lie, linear between neighbours; share in [0, 1]. 0 where there
// are none.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    double at = std::clamp(share, 0.0, 1.0) * double(values.size() - 1);
    size_t below = std::min(size_t(at), values.size() - 1);
    size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (at - double(below));
}
inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace coppice
