#include "editor/document/plant_set.h"

namespace coppice {
namespace {

int32_t floor_div(int32_t value, int32_t divisor) {
    return value >= 0 ? value / divisor : -((-(value + 1)) / divisor) - 1;
}

// By cell, sorted inside.
std::map<PlantCell, std::vector<PlacedPlant>> by_cell(std::span<const PlacedPlant> plants) {
    std::map<PlantCell, std::vector<PlacedPlant>> cells;
    for (const PlacedPlant& plant : plants) cells[PlantSet::cell_of(plant.x, plant.z)].push_back(plant);
    for (auto& [cell, of_cell] : cells) std::sort(of_cell.begin(), of_cell.end());
    return cells;
}

}  // namespace

PlantCell PlantSet::cell_of(int32_t x_steps, int32_t z_steps) {
    return {floor_div(x_steps, k_cell_steps), floor_div(z_steps, k_cell_steps)};
}

void PlantSet::add(std::span<const PlacedPlant> plants) {
    for (const auto& [cell, more] : by_cell(plants)) {
        std::vector<PlacedPlant>& there = cells_[cell];
        const ptrdiff_t before = ptrdiff_t(there.size());
        there.insert(there.end(), more.begin(), more.end());
        std::inplace_merge(there.begin(), there.begin() + before, there.end());
        changed_.insert(cell);
    }
    size_ += plants.size();
}

bool PlantSet::remove(std::span<const PlacedPlant> plants) {
    const auto cells = by_cell(plants);
    for (const auto& [cell, gone] : cells) {
        const auto found = cells_.find(cell);
        if (found == cells_.end() ||
            !std::includes(found->second.begin(), found->second.end(), gone.begin(), gone.end()))
            return false;
    }
    for (const auto& [cell, gone] : cells) {
        const auto found = cells_.find(cell);
        std::vector<PlacedPlant> left;
        left.reserve(found->second.size() - gone.size());
        std::set_difference(found->second.begin(), found->second.end(), gone.begin(), gone.end(),
                            std::back_inserter(left));
        if (left.empty())
            cells_.erase(found);
        else
            found->second = std::move(left);
        changed_.insert(cell);
    }
    size_ -= plants.size();
    return true;
}

std::vector<PlacedPlant> PlantSet::all() const {
    std::vector<PlacedPlant> plants;
    plants.reserve(size_);
    for (const auto& [cell, of_cell] : cells_) plants.insert(plants.end(), of_cell.begin(), of_cell.end());
    return plants;
}

}  // namespace coppice
