#include "plugins/vegetation/loose_plants.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include "plugins/vegetation/eco/make_tiles.h"

namespace coppice {
namespace {

constexpr double k_farthest_m = 1e9;

uint64_t square_of(const dvec3& place_world) {
    const auto index = [](double at_m) { return uint32_t(int32_t(std::floor(at_m / k_loose_square_m))); };
    return uint64_t(index(place_world.x)) << 32 | index(place_world.z);
}

tl::unexpected<Error> refuse(ErrorId id, std::string fault, std::string remedy) {
    return fail(id, "", "loose plant", std::move(fault), std::move(remedy));
}

constexpr uint32_t k_gone = UINT32_MAX;

// Of each old model the new one: a plant's variations are models of one name, and the n-th stays the n-th; where there are
// fewer now, it begins again with the first.
std::vector<uint32_t> match_models(std::span<const LooseModel> before, std::span<const LooseModel> after) {
    std::map<std::string_view, std::vector<uint32_t>> named;
    for (uint32_t m = 0; m < after.size(); ++m) named[after[m].name].push_back(m);
    std::map<std::string_view, size_t> seen;
    std::vector<uint32_t> matched;
    for (const LooseModel& model : before) {
        const auto found = named.find(model.name);
        const size_t nth = seen[model.name]++;
        matched.push_back(found == named.end() ? k_gone : found->second[nth % found->second.size()]);
    }
    return matched;
}

}  // namespace

Status LoosePlants::check(const Placement& placement) const {
    const dvec3& at = placement.position_world;
    for (const double meters : {at.x, at.y, at.z})
        if (!(std::fabs(meters) <= k_farthest_m))
            return refuse(ErrorId::value_out_of_range, "a place of " + std::to_string(meters) + " m",
                          "at most 10^9 m from the origin");
    if (!(placement.scale > 0.0f) || !std::isfinite(placement.scale))
        return refuse(ErrorId::value_out_of_range, "a scale of " + std::to_string(placement.scale),
                      "above 0");
    if (placement.model.model >= models_.size())
        return refuse(ErrorId::value_out_of_range, "model " + std::to_string(placement.model.model),
                      "the scene has " + std::to_string(models_.size()) + " models");
    return {};
}

Result<LoosePlants::Place> LoosePlants::find(uint32_t plant) const {
    const auto found = place_of_.find(plant);
    if (found == place_of_.end())
        return refuse(ErrorId::name_unknown, "there is no plant " + std::to_string(plant),
                      "a number that add returned, of a plant that was not removed");
    return found->second;
}

bool LoosePlants::has_room(SquareName name, size_t left) const {
    const auto square = squares_.find(name);
    return (square != squares_.end() && !square->second.plants.empty()) ||
           used_squares_ - left < square_limit_;
}

void LoosePlants::put(uint32_t plant, SquareName name, const Placement& placement) {
    Square& square = squares_[name];
    used_squares_ += square.plants.empty();
    place_of_[plant] = {name, square.plants.size()};
    square.plants.push_back(plant);
    square.placements.push_back(placement);
    square.changed = true;
    stems_.set(place_stem(models_[placement.model.model].stem, placement.position_world, placement.turn,
                          placement.scale, plant));
}

// The last of the square takes its row.
void LoosePlants::take(const Place& place) {
    Square& square = squares_[place.square];
    place_of_.erase(square.plants[place.row]);
    square.plants[place.row] = square.plants.back();
    square.placements[place.row] = square.placements.back();
    square.plants.pop_back();
    square.placements.pop_back();
    if (place.row < square.plants.size()) place_of_[square.plants[place.row]].row = place.row;
    used_squares_ -= square.plants.empty();
    square.changed = true;
}

Result<uint32_t> LoosePlants::add(const Placement& placement) {
    COPPICE_CHECK(check(placement));
    const SquareName name = square_of(placement.position_world);
    if (!has_room(name, 0) || next_plant_ == StemHit::k_none)
        return refuse(ErrorId::limit_exceeded,
                      "plants in more than " + std::to_string(square_limit_) + " squares of 16 m",
                      "more loose_tiles, which a populated folder has none of, or plants nearer together");
    put(next_plant_, name, placement);
    return next_plant_++;
}

Status LoosePlants::move(uint32_t plant, const Placement& placement) {
    COPPICE_TRY(const Place place, find(plant));
    COPPICE_CHECK(check(placement));
    const SquareName name = square_of(placement.position_world);
    if (!has_room(name, squares_[place.square].plants.size() == 1))
        return refuse(ErrorId::limit_exceeded,
                      "plants in more than " + std::to_string(square_limit_) + " squares of 16 m",
                      "more loose_tiles, or plants nearer together");
    take(place);
    put(plant, name, placement);
    return {};
}

Status LoosePlants::remove(uint32_t plant) {
    COPPICE_TRY(const Place place, find(plant));
    take(place);
    stems_.remove(plant);
    return {};
}

Status LoosePlants::show_square(SquareName name, Square& square) {
    Scene scene;
    SceneTile tile{{}, 0, uint32_t(square.plants.size())};
    const dvec3& corner = square.placements.front().position_world;
    tile.tile.origin_world = dvec3(std::floor(corner.x), std::floor(corner.y), std::floor(corner.z));
    for (const Placement& placement : square.placements) {
        const vec3 at = vec3(placement.position_world - tile.tile.origin_world);
        scene.positions.push_back({at.x, at.y, at.z, placement.scale});
        scene.turns.push_back(placement.turn);
        scene.plant_models.push_back(placement.model);
    }
    scene.tiles = {tile};
    std::vector<Box> bounds;
    for (const LooseModel& model : models_) bounds.push_back(model.bounds_plant);
    finish_tiles(scene, bounds);
    return vegetation_.set_loose_tile(
        name, {scene.tiles.front().tile, scene.positions, scene.turns, scene.plant_models});
}

// First what makes room.
Status LoosePlants::show() {
    for (auto at = squares_.begin(); at != squares_.end();) {
        if (!at->second.plants.empty()) {
            ++at;
            continue;
        }
        COPPICE_CHECK(vegetation_.set_loose_tile(at->first, {}));
        at = squares_.erase(at);
    }
    for (auto& [name, square] : squares_) {
        if (!square.changed) continue;
        COPPICE_CHECK(show_square(name, square));
        square.changed = false;
    }
    return {};
}

size_t LoosePlants::change_models(std::vector<LooseModel> models) {
    std::map<SquareName, Square> before;
    std::swap(before, squares_);
    used_squares_ = 0;
    place_of_.clear();
    const std::vector<uint32_t> new_model = match_models(models_, models);
    models_ = std::move(models);
    size_t removed = 0;
    for (auto& [name, square] : before)
        for (size_t row = 0; row < square.plants.size(); ++row) {
            Placement placement = square.placements[row];
            placement.model.model = new_model[placement.model.model];
            if (placement.model.model != k_gone) {
                put(square.plants[row], name, placement);
            } else {
                stems_.remove(square.plants[row]);
                ++removed;
            }
        }
    return removed;
}

}  // namespace coppice
