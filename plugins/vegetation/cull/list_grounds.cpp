#include "plugins/vegetation/cull/list_grounds.h"

#include <algorithm>

namespace coppice {

std::vector<Ground> make_grounds(std::shared_ptr<const Terrain> terrain) {
    if (!terrain) return {};
    const Box local = bounds_without_skirts(*terrain);
    const dvec3 origin = terrain->origin_world();
    const Box bounds{vec3(origin + dvec3(local.min)), vec3(origin + dvec3(local.max))};
    CoarseGround coarse = make_coarse_ground(*terrain);
    return {{std::move(terrain), {}, bounds, std::move(coarse)}};
}

std::vector<Ground> make_grounds(const TileForest& forest) {
    std::vector<Ground> grounds;
    for (const ForestGround& of : forest.grounds)
        grounds.push_back({of.terrain,
                           {},
                           of.bounds,
                           of.terrain        ? make_coarse_ground(*of.terrain)
                           : of.without_gaps ? make_flat_ground(of.bounds, of.mean_color_linear)
                                             : CoarseGround{}});
    for (const ForestRow& row : forest.rows) {
        if (row.ground == k_no_row || grounds[row.ground].terrain || row.target != k_no_row) continue;
        std::vector<Ground::Place>& places = grounds[row.ground].places;
        if (!places.empty()) continue;
        for (uint32_t child = row.first_child; child < row.first_child + row.child_count; ++child) {
            const ForestRow& place = forest.rows[child];
            if (place.target == k_no_row) continue;
            const uint32_t ground = forest.rows[place.target].ground;
            if (ground != k_no_row && ground != row.ground) places.push_back({place.origin, ground});
        }
    }
    return grounds;
}

void GroundList::list(std::span<const Ground> grounds, const Frustum& frustum, dvec3 camera_world,
                      float error_px) {
    in_view_.clear();
    pending_.clear();
    if (!grounds.empty()) pending_.push_back({0, -camera_world, k_in_full});
    while (!pending_.empty()) {
        GroundInView at = pending_.back();
        pending_.pop_back();
        const Ground& ground = grounds[at.ground];
        const vec3 space = vec3(at.space_camera);
        const Box bounds{ground.bounds.min + space, ground.bounds.max + space};
        if (see_box(frustum, bounds) == Visibility::outside) continue;
        const float nearest_m = glm::length(glm::clamp(vec3(0.0f), bounds.min, bounds.max));
        for (uint32_t level = 0; level < ground.coarse.levels.size() && at.coarse_level == k_in_full; ++level)
            if (ground.coarse.levels[level].error_m * frustum.focal_px < error_px * nearest_m)
                at.coarse_level = level;
        if (at.coarse_level != k_in_full || ground.terrain)
            in_view_.push_back(at);
        else
            for (size_t i = ground.places.size(); i-- > 0;)
                pending_.push_back(
                    {ground.places[i].ground, at.space_camera + ground.places[i].origin, k_in_full});
    }
}

}  // namespace coppice
