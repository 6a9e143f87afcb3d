// Plants seen in columns are what the plain functions say of each: rotation_matrix, sees_sphere, pixels_per_meter,
// off_axis_stretch.
#include "plugins/vegetation/draw/see_plants.h"
#include <gtest/gtest.h>
#include <cmath>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

struct Stand {
    std::vector<PlantPosition> positions;
    std::vector<PlantTurn> turns;
    std::vector<PlantModel> models;
};

constexpr vec3 k_origin_camera(3.0f, -2.0f, -40.0f);

// Of two models in runs of 1 to 90, around and behind the viewer, turned every way.
Stand make_stand(uint32_t count) {
    Stand stand;
    uint32_t next = 1;
    auto number = [&next](float low, float high) {
        next = mix_bits(next + 0x9e3779b9u);
        return low + (high - low) * (float(next >> 8) * 0x1p-24f);
    };
    uint32_t model = 0;
    for (uint32_t i = 0, left = 1; i < count; ++i) {
        if (left-- == 0) {
            model ^= 1u;
            left = uint32_t(number(0.0f, 90.0f));
        }
        stand.positions.push_back(
            {number(-60.0f, 60.0f), number(-5.0f, 5.0f), number(-60.0f, 60.0f), number(0.3f, 2.0f)});
        const vec4 q = glm::normalize(vec4(number(-1, 1), number(-1, 1), number(-1, 1), number(0.05f, 1)));
        stand.turns.push_back(pack_turn(q.x, q.y, q.z, q.w));
        stand.models.push_back({model, i});
    }
    return stand;
}

SceneGeometry two_models() {
    SceneGeometry geometry;
    geometry.models.push_back({vec3(0.3f, 4.0f, -0.2f), 4.5f, 9.0f, 0, 0, 100, false});
    geometry.models.push_back({vec3(0.0f, 0.3f, 0.0f), 0.4f, 0.75f, 0, 0, 7, false});
    return geometry;
}

TEST(SeePlants, ColumnsAreWhatThePlainFunctionsSay) {
    Camera camera;
    camera.position_world = dvec3(0.0);
    camera.vertical_fov_rad = 1.1f;
    const Frustum frustum = make_frustum(camera, 795, 700);
    const SceneGeometry geometry = two_models();
    for (const uint32_t count : {0u, 1u, 63u, 64u, 65u, 2000u}) {
        const Stand stand = make_stand(count);
        SeenPlants seen;
        see_plants({k_origin_camera, false, stand.positions, stand.turns, stand.models}, geometry, frustum,
                   nullptr, 0.0f, seen);
        uint32_t at = 0;
        uint64_t full_triangles = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const DrawModel& model = geometry.models[stand.models[i].model];
            const PlantPosition& place = stand.positions[i];
            const mat3 rotation = rotation_matrix(stand.turns[i]);
            const vec3 foot = k_origin_camera + vec3(place.x_tile, place.y_tile, place.z_tile);
            const vec3 center = foot + rotation * (model.center_plant * place.scale);
            const float radius_m = model.radius_m * place.scale, distance_m = glm::length(center);
            const bool is_next = at < seen.plant_count && seen.seed[at] == i;
            // A hair beside the edge either answer will do.
            const bool surely_seen = sees_sphere(frustum, center, radius_m - 1.0e-4f);
            const bool perhaps_seen = sees_sphere(frustum, center, radius_m + 1.0e-4f);
            ASSERT_TRUE(is_next ? perhaps_seen : !surely_seen) << i;
            if (!is_next) continue;
            full_triangles += model.triangle_count;
            const vec3 direction = glm::transpose(rotation) * center / distance_m;
            EXPECT_NEAR(seen.direction_x[at], direction.x, 2.0e-5f) << i;
            EXPECT_NEAR(seen.direction_y[at], direction.y, 2.0e-5f) << i;
            EXPECT_NEAR(seen.direction_z[at], direction.z, 2.0e-5f) << i;
            const float per_meter_px =
                pixels_per_meter(frustum.focal_px, distance_m, radius_m, frustum.near_m, place.scale) *
                off_axis_stretch(frustum, center, distance_m);
            EXPECT_NEAR(seen.pixels_per_meter[at] / per_meter_px, 1.0f, 1.0e-4f) << i;
            EXPECT_EQ(seen.instances[at].x_camera, foot.x) << i;
            EXPECT_EQ(seen.instances[at].y_camera, foot.y) << i;
            EXPECT_EQ(seen.instances[at].z_camera, foot.z) << i;
            EXPECT_EQ(seen.instances[at].scale, place.scale) << i;
            EXPECT_EQ(seen.instances[at].turn_x, float(stand.turns[i].x) * k_turn_step) << i;
            EXPECT_EQ(seen.instances[at].turn_w, float(stand.turns[i].w) * k_turn_step) << i;
            ++at;
        }
        EXPECT_EQ(at, seen.plant_count);
        EXPECT_EQ(full_triangles, seen.full_triangles);
        EXPECT_TRUE(count < 2000 || (at > 200 && at < 1500)) << at;  // both answers were tried
    }
}

TEST(SeePlants, GroupsAreRunsOfOneModelAndHoldAll) {
    const Frustum frustum = make_frustum(Camera{}, 795, 700);
    const SceneGeometry geometry = two_models();
    const Stand stand = make_stand(3000);
    SeenPlants seen;
    see_plants({k_origin_camera, true, stand.positions, stand.turns, stand.models}, geometry, frustum,
               nullptr, 0.0f, seen);
    ASSERT_EQ(seen.plant_count, 3000u);  // of a tile wholly in view none is left out
    uint32_t next = 0;
    for (const SeenGroup& group : seen.groups) {
        ASSERT_EQ(group.first, next);
        ASSERT_GT(group.end, group.first);
        ASSERT_LE(group.end - group.first, k_plants_a_batch);
        for (uint32_t i = group.first; i < group.end; ++i)
            ASSERT_EQ(stand.models[seen.seed[i]].model, group.model) << i;
        next = group.end;
    }
    EXPECT_EQ(next, seen.plant_count);
}

TEST(SeePlants, AViewerInAPlantsMiddleGetsFiniteNumbers) {
    const Frustum frustum = make_frustum(Camera{}, 795, 700);
    const SceneGeometry geometry = two_models();
    Stand stand = make_stand(1);
    stand.models[0].model = 0;
    stand.turns[0] = pack_turn(0.0f, 0.0f, 0.0f, 1.0f);
    stand.positions[0] = {-0.3f, -4.0f, 0.2f, 1.0f};
    SeenPlants seen;
    see_plants({vec3(0.0f), false, stand.positions, stand.turns, stand.models}, geometry, frustum, nullptr,
               0.0f, seen);
    ASSERT_EQ(seen.plant_count, 1u);
    const vec3 direction(seen.direction_x[0], seen.direction_y[0], seen.direction_z[0]);
    EXPECT_NEAR(glm::length(direction), 1.0f, 1.0e-3f);
    EXPECT_TRUE(std::isfinite(seen.pixels_per_meter[0]));
    EXPECT_GT(seen.pixels_per_meter[0], 0.0f);
}

}  // namespace
}  // namespace coppice
