#include "plugins/vegetation/cull/list_tiles.h"

#include <algorithm>
#include <tuple>

namespace coppice {

void TileList::list(const Plants& plants, const Frustum& frustum, dvec3 camera_world) {
    tiles_.clear();
    runs_.clear();
    tile_count = visible_tile_count = plant_count = 0;
    plants.each_chunk([&](const ChunkView& chunk, std::span<const PlantPosition> positions,
                          std::span<const PlantTurn> turns, std::span<const PlantModel> models,
                          const Tile& tile) {
        ++tile_count;
        plant_count += chunk.size();
        vec3 origin = vec3(tile.origin_world - camera_world);
        Box bounds{tile.bounds_tile.min + origin, tile.bounds_tile.max + origin};
        Visibility visibility = see_box(frustum, bounds);
        if (visibility == Visibility::outside) return;
        float distance_m = glm::length(glm::clamp(vec3(0.0f), bounds.min, bounds.max));
        tiles_.push_back({distance_m,
                          chunk.entity(0).index,
                          {origin, visibility == Visibility::inside, positions, turns, models}});
    });
    visible_tile_count = uint32_t(tiles_.size());
    std::sort(tiles_.begin(), tiles_.end(), [](const VisibleTile& a, const VisibleTile& b) {
        return std::tuple(a.distance_m, a.first_index) < std::tuple(b.distance_m, b.first_index);
    });
    for (const VisibleTile& tile : tiles_)
        for (size_t first = 0; first < tile.plants.positions.size(); first += k_plants_a_run) {
            size_t count = std::min<size_t>(k_plants_a_run, tile.plants.positions.size() - first);
            runs_.push_back(
                {tile.plants.origin_camera, tile.plants.inside, tile.plants.positions.subspan(first, count),
                 tile.plants.turns.subspan(first, count), tile.plants.models.subspan(first, count)});
        }
}

}  // namespace coppice
