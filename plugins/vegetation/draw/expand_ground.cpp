#include "plugins/vegetation/draw/expand_ground.h"

#include "plugins/vegetation/cull/ground_level.h"

namespace coppice {
namespace {

uint64_t expand_terrain(const Terrain& terrain, vec3 origin_camera, uint32_t first_vertex,
                        const Frustum& frustum, float error_px, WorkPart& work) {
    const uint32_t instance = work.add_instance(instance_of(mat3(1.0f), 1.0f, origin_camera));
    uint64_t triangles = 0;
    for (const TerrainPatch& patch : terrain.patches()) {
        const Box bounds{patch.bounds_local.min + origin_camera, patch.bounds_local.max + origin_camera};
        if (patch.level_count == 0 || see_box(frustum, bounds) == Visibility::outside) continue;
        const TerrainLevel& level =
            terrain.levels()[patch.first_level +
                             choose_ground_level(patch, terrain.levels(), bounds, frustum, error_px)];
        work.add_ground(first_vertex + level.first_vertex, level.vertex_count / 3, instance);
        triangles += level.vertex_count / 3;
    }
    return triangles;
}

}  // namespace

uint64_t expand_grounds(std::span<const GroundInView> in_view, const SceneGeometry& geometry,
                        const Frustum& frustum, float error_px, WorkPart& work) {
    uint64_t triangles = 0;
    for (const GroundInView& at : in_view) {
        const DrawGround& ground = geometry.grounds[at.ground];
        if (at.coarse_level != k_in_full) {
            const CoarseGround::Level& level = ground.coarse_levels[at.coarse_level];
            work.add_ground(ground.first_coarse_vertex + level.first_vertex, level.vertex_count / 3,
                            work.add_instance(instance_of(mat3(1.0f), 1.0f, vec3(at.space_camera))));
            triangles += level.vertex_count / 3;
        } else if (ground.terrain) {
            triangles +=
                expand_terrain(*ground.terrain, vec3(ground.terrain->origin_world() + at.space_camera),
                               ground.first_vertex, frustum, error_px, work);
        }
    }
    return triangles;
}

}  // namespace coppice
