// The placed plants of one file, in square cells: a multiset, so that what was taken out and put back is what was there.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>
#include "plugins/vegetation/eco/placed_plants.h"

namespace coppice {

// A cell's corner of least x and z, in cells.
struct PlantCell {
    int32_t x = 0, z = 0;
    auto operator<=>(const PlantCell&) const = default;
};

class PlantSet {
  public:
    static constexpr int32_t k_cell_steps = 4096;  // 32 m
    static constexpr double k_cell_m = k_cell_steps / k_placed_steps_per_m;
    static PlantCell cell_of(int32_t x_steps, int32_t z_steps);

    void add(std::span<const PlacedPlant> plants);
    // Each as often as it is named; false, and nothing is changed, where one is not there.
    bool remove(std::span<const PlacedPlant> plants);

    size_t size() const { return size_; }
    // Sorted; none is empty.
    const std::map<PlantCell, std::vector<PlacedPlant>>& cells() const { return cells_; }
    std::vector<PlacedPlant> all() const;
    // Those within the box, in order of cells. visit(const PlacedPlant&)
    template <class Visit>
    void each_in(dvec2 low, dvec2 high, Visit&& visit) const;

    // Cells that are not as they were at the last call; for who draws them.
    std::set<PlantCell> take_changed() { return std::exchange(changed_, {}); }

  private:
    std::map<PlantCell, std::vector<PlacedPlant>> cells_;
    std::set<PlantCell> changed_;
    size_t size_ = 0;
};

template <class Visit>
void PlantSet::each_in(dvec2 low, dvec2 high, Visit&& visit) const {
    auto cell_at = [](double metres) {
        return int32_t(std::clamp(std::floor(metres / k_cell_m), -524288.0, 524287.0));
    };
    const PlantCell first{cell_at(low.x), cell_at(low.y)}, last{cell_at(high.x), cell_at(high.y)};
    for (int32_t x = first.x; x <= last.x; ++x) {
        // One column's cells follow each other; what lies between columns is passed over.
        auto cell = cells_.lower_bound({x, first.z});
        if (cell == cells_.end()) return;
        if (cell->first.x > x) {
            x = cell->first.x - 1;
            continue;
        }
        for (; cell != cells_.end() && cell->first.x == x && cell->first.z <= last.z; ++cell)
            for (const PlacedPlant& plant : cell->second) {
                const dvec2 at = ground_place(plant);
                if (at.x >= low.x && at.x <= high.x && at.y >= low.y && at.y <= high.y) visit(plant);
            }
    }
}

}  // namespace coppice
