#include "plugins/vegetation/eco/near_places.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace coppice {

NearPlaces::NearPlaces(std::span<const dvec2> places, double distance_m) : distance_m_(distance_m) {
    cells_.reserve(places.size());
    for (const dvec2& place : places)
        cells_.push_back({int64_t(std::floor(place.y / distance_m)), int64_t(std::floor(place.x / distance_m)), place});
    std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
        return std::tie(a.row, a.column, a.place.x, a.place.y) < std::tie(b.row, b.column, b.place.x, b.place.y);
    });
}

bool NearPlaces::contains(dvec2 p) const {
    const int64_t row = int64_t(std::floor(p.y / distance_m_)), column = int64_t(std::floor(p.x / distance_m_));
    for (int64_t r = row - 1; r <= row + 1; ++r) {
        auto cell = std::lower_bound(cells_.begin(), cells_.end(), std::pair(r, column - 1),
                                     [](const Cell& c, const std::pair<int64_t, int64_t>& at) {
                                         return std::pair(c.row, c.column) < at;
                                     });
        for (; cell != cells_.end() && cell->row == r && cell->column <= column + 1; ++cell) {
            const dvec2 away = cell->place - p;
            if (away.x * away.x + away.y * away.y < distance_m_ * distance_m_) return true;
        }
    }
    return false;
}

}  // namespace coppice
