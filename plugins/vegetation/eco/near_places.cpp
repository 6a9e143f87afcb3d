#include "plugins/vegetation/eco/near_places.h"

#include <algorithm>
#include <cmath>

namespace coppice {

NearPlaces::NearPlaces(std::span<const dvec2> places, double distance_m)
    : distance_m_(distance_m), tree_(places.begin(), places.end()) {
    sort(0, tree_.size(), 0);
}

void NearPlaces::sort(size_t first, size_t end, int axis) {
    if (end - first < 2) return;
    const size_t middle = first + (end - first) / 2;
    std::nth_element(tree_.begin() + ptrdiff_t(first), tree_.begin() + ptrdiff_t(middle), tree_.begin() + ptrdiff_t(end),
                     [axis](const dvec2& a, const dvec2& b) { return a[axis] < b[axis]; });
    sort(first, middle, 1 - axis);
    sort(middle + 1, end, 1 - axis);
}

bool NearPlaces::contains(size_t first, size_t end, int axis, dvec2 p) const {
    if (first == end) return false;
    const size_t middle = first + (end - first) / 2;
    const dvec2 away = tree_[middle] - p;
    if (away.x * away.x + away.y * away.y < distance_m_ * distance_m_) return true;
    const bool lies_below = away[axis] > 0.0;
    const auto half = [&](bool below) {
        return below ? contains(first, middle, 1 - axis, p) : contains(middle + 1, end, 1 - axis, p);
    };
    return half(lies_below) || (std::fabs(away[axis]) < distance_m_ && half(!lies_below));
}

}  // namespace coppice
