#include "plugins/vegetation/cull/list_tiles.h"

#include <algorithm>
#include <tuple>

namespace coppice {
namespace {

// What will be needed soon comes behind what is needed now.
constexpr float k_soon_share = 0.25f;
constexpr float k_widest_spread_px = 32.0f;  // splat_points.comp

float distance_m(const Box& box, vec3 from) { return glm::length(glm::clamp(from, box.min, box.max) - from); }
float farthest_m(const Box& box) { return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max))); }

}  // namespace

TileList::Pending TileList::arrive(Pending at) const {
    while (levels_of_row_[at.row].target != TileLevels::k_none) {
        at.space_camera += tile_of_row_[at.row].origin_world;
        at.row = levels_of_row_[at.row].target;
    }
    return at;
}

bool TileList::lacks_detail(const TileLevels& levels, const Pending& at) const {
    if (levels.child_count == 0) return levels.is_streamed && plants_of_row_[at.row].positions.empty();
    for (uint32_t i = 0; i < levels.child_count; ++i) {
        Pending child = at;
        child.row = levels.first_child + i;
        if (levels_of_row_[arrive(child).row].cloud == TileLevels::k_none) return true;
    }
    return false;
}

// What is drawn of a tile from memory says how far beside the tile it can be seen: were a stand-in left out sooner, its
// larger points would vanish in full view. What is wished for must not follow from what is in memory: a tile that is read
// because its stand-in shows would be forgotten once it is there and hidden, and read again.
TileList::SeenTile TileList::see(const Pending& at, const Frustum& frustum, const Settings& settings) const {
    const Tile& tile = tile_of_row_[at.row];
    const TileLevels& levels = levels_of_row_[at.row];
    SeenTile seen;
    seen.origin_camera = vec3(tile.origin_world + at.space_camera);
    seen.bounds_camera = {tile.bounds_tile.min + seen.origin_camera,
                          tile.bounds_tile.max + seen.origin_camera};
    seen.nearest_m = distance_m(seen.bounds_camera, vec3(0.0f));
    // What is nearest asks for most.
    const float most_px = most_pixels_per_meter(frustum, seen.bounds_camera, seen.nearest_m);
    auto density_at = [&](float per_meter_px) {
        const float per_meter = per_meter_px / settings.sample_distance_px;
        return settings.sample_distance_px > 0.0f ? per_meter * per_meter : INFINITY;
    };
    const float soon_m = std::min(seen.nearest_m, distance_m(seen.bounds_camera, settings.motion_m));
    seen.density = density_at(most_px);
    seen.density_soon = density_at(most_pixels_per_meter(frustum, seen.bounds_camera, soon_m));

    const bool suffices = seen.density <= levels.finest_density;
    const float sample_distance_px = most_px / std::sqrt(std::max(levels.finest_density, 1e-12f));
    seen.stand_in_spread_px =
        suffices ? settings.spread_px
                 : std::max(settings.spread_px,
                            std::min(settings.stand_in_spread * sample_distance_px, k_widest_spread_px));
    const float shown_px = levels.cloud == TileLevels::k_none      ? at.stand_in_spread_px
                           : !suffices && lacks_detail(levels, at) ? seen.stand_in_spread_px
                                                                   : settings.spread_px;
    const float most_spread_px = std::max(at.stand_in_spread_px, seen.stand_in_spread_px);
    const Visibility visibility = at.inside ? Visibility::inside : see_box(frustum, seen.bounds_camera);
    seen.inside = visibility == Visibility::inside;
    auto is_outside = [&](float spread_px) {
        if (visibility != Visibility::outside) return false;
        // That ordinary points reach over the picture's border by a pixel or two counts nowhere.
        if (spread_px <= settings.spread_px) return true;
        const float beside_m = spread_px / frustum.focal_px * farthest_m(seen.bounds_camera);
        return see_box(frustum, {seen.bounds_camera.min - beside_m, seen.bounds_camera.max + beside_m}) ==
               Visibility::outside;
    };
    auto is_hidden = [&](float spread_px) {
        return settings.horizon && settings.horizon->hidden(seen.bounds_camera, spread_px);
    };
    seen.outside = is_outside(shown_px);
    seen.hidden = !seen.outside && is_hidden(shown_px);
    seen.left_out = (seen.outside || seen.hidden) &&
                    (most_spread_px <= shown_px || is_outside(most_spread_px) || is_hidden(most_spread_px));
    const float size_px =
        glm::length(tile.bounds_tile.size()) * frustum.focal_px / std::max(soon_m, frustum.near_m);
    seen.priority = std::min(size_px * size_px, 1e30f) * (at.soon ? k_soon_share : 1.0f);
    return seen;
}

bool TileList::all_children_drawable(const TileLevels& levels, const Pending& at, float stand_in_spread_px,
                                     const Frustum& frustum, const Settings& settings) const {
    for (uint32_t i = 0; i < levels.child_count; ++i) {
        Pending child = at;
        child.row = levels.first_child + i;
        child.stand_in_spread_px = stand_in_spread_px;
        child = arrive(child);
        // What is not streamed is in memory: what has no cloud there is drawn plant by plant.
        const TileLevels& of_child = levels_of_row_[child.row];
        if (of_child.cloud != TileLevels::k_none || !of_child.is_streamed) continue;
        const SeenTile seen = see(child, frustum, settings);
        if (!seen.outside && !seen.hidden) return false;
    }
    return true;
}

void TileList::visit(Pending at, const Frustum& frustum, const Settings& settings) {
    at = arrive(at);
    ++touched_tile_count;
    const Tile& tile = tile_of_row_[at.row];
    const TileLevels& levels = levels_of_row_[at.row];
    const SeenTile seen = see(at, frustum, settings);
    hidden_tile_count += seen.hidden && at.drawn;
    if (seen.left_out) return;
    if (seen.outside || seen.hidden) at.drawn = false;
    if (levels.is_streamed) wishes_.push_back({at.row, TileBlockKind::cloud, seen.priority});

    const bool suffices = seen.density <= levels.finest_density;
    const bool refines_soon = seen.density_soon > levels.finest_density;
    bool refined = false;
    if (refines_soon && levels.child_count == 0) {
        if (levels.is_streamed) wishes_.push_back({at.row, TileBlockKind::plants, seen.priority});
        refined = at.drawn && !suffices && !plants_of_row_[at.row].positions.empty();
        if (refined)
            expanded_.push_back({seen.nearest_m, at.row, seen.inside, seen.origin_camera,
                                 settings.horizon && settings.horizon->hides_some(seen.bounds_camera)});
    } else if (refines_soon) {
        refined = at.drawn && !suffices &&
                  all_children_drawable(levels, at, seen.stand_in_spread_px, frustum, settings);
        // All that is missing on the way down is wished for at once.
        for (uint32_t i = 0; i < levels.child_count; ++i)
            pending_.push_back({levels.first_child + i, seen.inside, refined, at.soon || suffices,
                                at.space_camera, seen.stand_in_spread_px});
    }
    if (refined || !at.drawn || levels.cloud == TileLevels::k_none) return;
    const bool stands_in = !suffices && (levels.child_count > 0 || levels.is_streamed);
    stand_in_count += stands_in;
    clouds_.push_back({levels.cloud, seen.origin_camera, seen.bounds_camera, seen.nearest_m,
                       levels.finest_density, tile.plant_count, levels.triangle_count, stands_in});
}

void TileList::collect_plants(const Plants& plants) {
    plants_of_row_.assign(tile_of_row_.size(), {});
    plants.each_chunk([&](const ChunkView&, std::span<const PlantPosition> positions,
                          std::span<const PlantTurn> turns, std::span<const PlantModel> models,
                          const Tile& tile) {
        // Another user of the world may have tiles too.
        const size_t row = (uintptr_t(&tile) - uintptr_t(tile_of_row_.data())) / sizeof(Tile);
        if (row >= tile_of_row_.size()) return;
        plants_of_row_[row] = {positions, turns, models};
        ++tile_count;
    });
}

void TileList::list(const Tiles& tiles, const Plants& plants, const Frustum& frustum, dvec3 camera_world,
                    const Settings& settings) {
    runs_.clear();
    clouds_.clear();
    expanded_.clear();
    wishes_.clear();
    tile_count = expanded_tile_count = touched_tile_count = hidden_tile_count = stand_in_count = 0;
    plant_count = 0;
    bounds_camera_ = {};
    tile_of_row_ = {};
    tiles.each_chunk(
        [&](const ChunkView&, std::span<const Tile> some_tiles, std::span<const TileLevels> levels) {
            tile_of_row_ = some_tiles;
            levels_of_row_ = levels;
        });
    if (tile_of_row_.empty()) return;
    plant_count = tile_of_row_[0].plant_count;
    const vec3 origin = vec3(tile_of_row_[0].origin_world - camera_world);
    bounds_camera_ = {tile_of_row_[0].bounds_tile.min + origin, tile_of_row_[0].bounds_tile.max + origin};
    collect_plants(plants);

    pending_.assign(1, {0, false, true, false, -camera_world, settings.spread_px});
    while (!pending_.empty()) {
        const Pending at = pending_.back();
        pending_.pop_back();
        visit(at, frustum, settings);
    }

    // One row may stand in several places that are equally far.
    auto by_distance = [](const auto& a, const auto& b, uint32_t row_a, uint32_t row_b) {
        return std::tuple(a.nearest_m, row_a, a.origin_camera.x, a.origin_camera.z) <
               std::tuple(b.nearest_m, row_b, b.origin_camera.x, b.origin_camera.z);
    };
    std::sort(clouds_.begin(), clouds_.end(),
              [&](const CloudTile& a, const CloudTile& b) { return by_distance(a, b, a.cloud, b.cloud); });
    std::sort(expanded_.begin(), expanded_.end(),
              [&](const ExpandedTile& a, const ExpandedTile& b) { return by_distance(a, b, a.row, b.row); });
    make_runs();
}

void TileList::make_runs() {
    expanded_tile_count = uint32_t(expanded_.size());
    for (const ExpandedTile& tile : expanded_) {
        const TilePlants& of = plants_of_row_[tile.row];
        for (size_t first = 0; first < of.positions.size(); first += k_plants_a_run) {
            const size_t count = std::min<size_t>(k_plants_a_run, of.positions.size() - first);
            runs_.push_back({tile.origin_camera, tile.inside, of.positions.subspan(first, count),
                             of.turns.subspan(first, count), of.models.subspan(first, count),
                             tile.may_be_hidden});
        }
    }
}

}  // namespace coppice
