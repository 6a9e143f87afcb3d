#include "plugins/vegetation/cull/coarse_ground.h"

#include <cmath>
#include <gtest/gtest.h>
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/cull/list_grounds.h"

namespace coppice {
namespace {

std::shared_ptr<Terrain> hills(const char* json) {
    auto terrain = load_terrain(json, "", "test");
    EXPECT_TRUE(terrain) << to_string(terrain.error());
    return terrain ? *terrain : nullptr;
}
constexpr const char* k_hills =
    R"({"procedural": {"size_m": 512, "cell_m": 4, "seed": 7, "amplitude_m": 20, "wavelength_m": 120}})";

// Height of the level's triangles that face up, at a place inside one.
float height_of(const CoarseGround& ground, const CoarseGround::Level& level, float x, float z) {
    float found = NAN;
    for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; v += 3) {
        const PackedVertex &a = ground.vertices[v], &b = ground.vertices[v + 1], &c = ground.vertices[v + 2];
        const float det = (b.x_plant - a.x_plant) * (c.z_plant - a.z_plant) -
                          (c.x_plant - a.x_plant) * (b.z_plant - a.z_plant);
        if (std::fabs(det) < 1e-3f) continue;  // a skirt
        const float s =
            ((x - a.x_plant) * (c.z_plant - a.z_plant) - (c.x_plant - a.x_plant) * (z - a.z_plant)) / det;
        const float t =
            ((b.x_plant - a.x_plant) * (z - a.z_plant) - (x - a.x_plant) * (b.z_plant - a.z_plant)) / det;
        if (s < 0.0f || t < 0.0f || s + t > 1.0f) continue;
        EXPECT_LT(det, 0.0f) << "wound as the terrain's triangles are: seen from above";
        found = a.y_plant + s * (b.y_plant - a.y_plant) + t * (c.y_plant - a.y_plant);
    }
    return found;
}

TEST(CoarseGround, ErrorsHoldAtEverySampleAndAreReached) {
    const auto terrain = hills(k_hills);
    ASSERT_TRUE(terrain);
    const CoarseGround ground = make_coarse_ground(*terrain);
    ASSERT_EQ(ground.levels.size(), k_coarse_ground_levels);
    const dvec3 origin = terrain->origin_world();
    for (size_t l = 0; l < ground.levels.size(); ++l) {
        float worst = 0.0f;
        // Off the samples by a little, so that no place lies on an edge.
        for (float z = -255.9f; z < 256.0f; z += 8.0f)
            for (float x = -255.8f; x < 256.0f; x += 8.0f) {
                const float height = height_of(ground, ground.levels[l], x, z);
                ASSERT_FALSE(std::isnan(height)) << x << ", " << z;
                worst =
                    std::max(worst, std::fabs(height - float(origin.y) -
                                              terrain->height_at(x - float(origin.x), z - float(origin.z))));
            }
        const float colors_m = k_color_error_share * 512.0f / float(1u << l);
        EXPECT_LE(worst, ground.levels[l].error_m * 1.01f + 0.01f);
        EXPECT_GE(std::max(worst, colors_m), ground.levels[l].error_m * 0.6f);
        EXPECT_GE(ground.levels[l].error_m, colors_m);
        if (l > 0) {
            EXPECT_GT(ground.levels[l].vertex_count, ground.levels[l - 1].vertex_count);
        }
    }
    EXPECT_LT(ground.levels.back().error_m, ground.levels.front().error_m);
}

TEST(CoarseGround, IsChosenWhereItIsOffByLessThanAPixel) {
    const std::vector<Ground> grounds = make_grounds(hills(k_hills));
    ASSERT_EQ(grounds.size(), 1u);
    Camera camera;
    GroundList list;
    uint32_t last = k_in_full;
    for (double away_m : {100.0, 3000.0, 10'000.0, 100'000.0}) {
        camera.position_world = dvec3(0.0, 30.0, 256.0 + away_m);
        const Frustum frustum = make_frustum(camera, 800, 600);
        list.list(grounds, frustum, camera.position_world, 1.0f);
        ASSERT_EQ(list.in_view().size(), 1u);
        const uint32_t level = list.in_view()[0].coarse_level;
        if (away_m == 100.0) {
            EXPECT_EQ(level, k_in_full);
        }

        EXPECT_TRUE(last == k_in_full || level <= last);
        if (level != k_in_full) {
            EXPECT_LT(grounds[0].coarse.levels[level].error_m * frustum.focal_px, 1.01 * (away_m + 1.0));
        }
        last = level;
        list.list(grounds, frustum, camera.position_world, 0.0f);
        EXPECT_EQ(list.in_view()[0].coarse_level, k_in_full) << "without levels of detail";
    }
}

TEST(CoarseGround, FlatGroundKeepsItsColours) {
    const std::vector<Ground> grounds = make_grounds(hills(R"({"flat": {"size_m": 640, "cell_m": 4}})"));
    ASSERT_EQ(grounds.size(), 1u);
    Camera camera;
    camera.position_world = dvec3(0.0, 10.0, 0.0);
    const Frustum frustum = make_frustum(camera, 800, 600);
    GroundList list;
    list.list(grounds, frustum, camera.position_world, 1.0f);
    ASSERT_EQ(list.in_view().size(), 1u);
    EXPECT_EQ(list.in_view()[0].coarse_level, k_in_full) << "as one square it has one colour";
}

TEST(CoarseGround, NothingIsMadeOfNothing) {
    EXPECT_TRUE(make_grounds(nullptr).empty());
    const CoarseGround flat =
        make_flat_ground({vec3(-1.0f, 2.0f, -1.0f), vec3(1.0f, 2.0f, 1.0f)}, vec3(0.2f));
    ASSERT_EQ(flat.levels.size(), 1u);
    EXPECT_EQ(flat.levels[0].error_m, 0.0f);
    EXPECT_EQ(flat.vertices.size(), 6u);
}

}  // namespace
}  // namespace coppice
