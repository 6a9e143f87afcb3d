#include "plugins/vegetation/cull/list_tiles.h"

#include <algorithm>
#include <tuple>

namespace coppice {

void TileList::list(const Tiles& tiles, const Plants& plants, const Frustum& frustum, dvec3 camera_world,
                    const Settings& settings) {
    const float sample_distance_px = settings.sample_distance_px;
    runs_.clear();
    clouds_.clear();
    expanded_.clear();
    tile_count = expanded_tile_count = plant_count = touched_tile_count = hidden_tile_count = 0;
    std::span<const Tile> tile_of_row;
    std::span<const TileLevels> levels_of_row;
    tiles.each_chunk(
        [&](const ChunkView&, std::span<const Tile> some_tiles, std::span<const TileLevels> levels) {
            tile_of_row = some_tiles;
            levels_of_row = levels;
        });
    if (tile_of_row.empty()) return;
    plants_of_row_.assign(tile_of_row.size(), {});
    plants.each_chunk([&](const ChunkView& chunk, std::span<const PlantPosition> positions,
                          std::span<const PlantTurn> turns, std::span<const PlantModel> models,
                          const Tile& tile) {
        plants_of_row_[size_t(&tile - tile_of_row.data())] = {positions, turns, models};
        ++tile_count;
        plant_count += chunk.size();
    });

    pending_.assign(1, {0, false});
    while (!pending_.empty()) {
        const auto [row, known_inside] = pending_.back();
        pending_.pop_back();
        ++touched_tile_count;
        const Tile& tile = tile_of_row[row];
        const TileLevels& levels = levels_of_row[row];
        const vec3 origin = vec3(tile.origin_world - camera_world);
        const Box bounds{tile.bounds_tile.min + origin, tile.bounds_tile.max + origin};
        bool inside = known_inside;
        if (!inside) {
            const Visibility visibility = see_box(frustum, bounds);
            if (visibility == Visibility::outside) continue;
            inside = visibility == Visibility::inside;
        }
        if (settings.horizon && settings.horizon->hidden(bounds, settings.spread_px)) {
            ++hidden_tile_count;
            continue;
        }
        const float nearest_m = glm::length(glm::clamp(vec3(0.0f), bounds.min, bounds.max));
        // What is nearest asks for most.
        const float most_px = frustum.focal_px / std::max(nearest_m, frustum.near_m) *
                              off_axis_stretch(frustum, bounds.center(), glm::length(bounds.center()));
        const float density = most_px / sample_distance_px * (most_px / sample_distance_px);
        if (sample_distance_px > 0.0f && density <= levels.finest_density)
            clouds_.push_back(
                {levels.cloud, origin, bounds, nearest_m, tile.plant_count, levels.triangle_count});
        else if (levels.child_count == 0)
            expanded_.push_back(
                {nearest_m, row, inside, origin, settings.horizon && settings.horizon->hides_some(bounds)});
        else
            for (uint32_t child = 0; child < levels.child_count; ++child)
                pending_.push_back({levels.first_child + child, inside});
    }

    std::sort(clouds_.begin(), clouds_.end(), [](const CloudTile& a, const CloudTile& b) {
        return std::tuple(a.nearest_m, a.cloud) < std::tuple(b.nearest_m, b.cloud);
    });
    std::sort(expanded_.begin(), expanded_.end(), [](const ExpandedTile& a, const ExpandedTile& b) {
        return std::tuple(a.nearest_m, a.row) < std::tuple(b.nearest_m, b.row);
    });
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
