#include "plugins/vegetation/draw/expand_ground.h"

#include "plugins/vegetation/cull/ground_level.h"

namespace coppice {

// Of the sides at which another level begins, or the terrain ends.
uint64_t GroundExpander::expand_skirts(const Terrain& terrain, size_t patch, uint32_t first_vertex,
                                       uint32_t instance, WorkPart& work) const {
    const TerrainLayout layout = terrain.layout();
    const uint32_t drawn = level_of_patch_[patch];
    const TerrainLevel& level = terrain.levels()[terrain.patches()[patch].first_level + drawn];
    uint32_t skirt = first_vertex + level.first_vertex + level.surface_vertex_count();
    uint64_t triangles = 0;
    auto draw = [&](bool meets_other, uint32_t vertex_count) {
        if (meets_other && vertex_count > 0) {
            work.add_ground(skirt, vertex_count / 3, instance);
            triangles += vertex_count / 3;
        }
        skirt += vertex_count;
    };
    const size_t across = (layout.cells_x + k_patch_cells - 1) / k_patch_cells;
    const size_t count = level_of_patch_.size();
    if (across == 0 || count % across != 0) {
        draw(true, 2 * (level.x_skirt_vertex_count + level.z_skirt_vertex_count));
        return triangles;
    }
    const size_t column = patch % across;
    draw(patch < across || level_of_patch_[patch - across] != drawn, level.x_skirt_vertex_count);
    draw(patch + across >= count || level_of_patch_[patch + across] != drawn, level.x_skirt_vertex_count);
    draw(column == 0 || level_of_patch_[patch - 1] != drawn, level.z_skirt_vertex_count);
    draw(column + 1 == across || level_of_patch_[patch + 1] != drawn, level.z_skirt_vertex_count);
    return triangles;
}

uint64_t GroundExpander::expand_terrain(const Terrain& terrain, vec3 origin_camera, uint32_t first_vertex,
                                        const Frustum& frustum, float error_px, WorkPart& work,
                                        float least_slope) {
    const std::span<const TerrainPatch> patches = terrain.patches();
    auto bounds_of = [&](const TerrainPatch& patch) {
        return Box{patch.bounds_local.min + origin_camera, patch.bounds_local.max + origin_camera};
    };
    level_of_patch_.resize(patches.size());
    for (size_t p = 0; p < patches.size(); ++p)
        level_of_patch_[p] =
            patches[p].level_count == 0
                ? 0
                : choose_ground_level(patches[p], terrain.levels(), bounds_of(patches[p]), frustum, error_px);
    const uint32_t instance = work.add_instance(instance_at(origin_camera));
    uint64_t triangles = 0;
    for (size_t p = 0; p < patches.size(); ++p) {
        if (patches[p].level_count == 0 || patches[p].steepest < least_slope ||
            see_box(frustum, bounds_of(patches[p])) == Visibility::outside)
            continue;
        const TerrainLevel& level = terrain.levels()[patches[p].first_level + level_of_patch_[p]];
        const uint32_t surface = level.surface_vertex_count() / 3;
        work.add_ground(first_vertex + level.first_vertex, surface, instance);
        triangles += surface + expand_skirts(terrain, p, first_vertex, instance, work);
    }
    return triangles;
}

uint64_t GroundExpander::expand(std::span<const GroundInView> in_view, const SceneGeometry& geometry,
                                const Frustum& frustum, float error_px, WorkPart& work, float least_slope) {
    uint64_t triangles = 0;
    for (const GroundInView& at : in_view) {
        const DrawGround& ground = geometry.grounds[at.ground];
        if (ground.steepest < least_slope) continue;
        if (at.coarse_level != k_in_full) {
            const CoarseGround::Level& level = ground.coarse_levels[at.coarse_level];
            work.add_ground(ground.first_coarse_vertex + level.first_vertex, level.vertex_count / 3,
                            work.add_instance(instance_at(vec3(at.space_camera))));
            triangles += level.vertex_count / 3;
        } else if (ground.terrain) {
            triangles +=
                expand_terrain(*ground.terrain, vec3(ground.terrain->origin_world() + at.space_camera),
                               ground.first_vertex, frustum, error_px, work, least_slope);
        }
    }
    return triangles;
}

}  // namespace coppice
