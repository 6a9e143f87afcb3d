// Triangles that are drawn side by side are alike, none is lost, points keep their triangle, and prefixes stay fair.
#include "plugins/vegetation/cook/group_triangles.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <set>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr uint32_t k_count = 2 * k_triangles_a_run + 101;

// One part of triangles of side 1 to 9, in no order; the first corner's x says which it was. A point for each.
PlantBlocks strewn_triangles() {
    PlantBlocks plant;
    PackedPart part{};
    part.triangle_count = part.point_count = k_count;
    plant.parts.push_back(part);
    for (uint32_t t = 0; t < k_count; ++t) {
        const float x = float(t), side = 1.0f + float(mix_bits(t + 1) % 1024u) / 128.0f;
        for (const vec3 corner : {vec3(x, 0, 0), vec3(x + side, 0, 0), vec3(x, 0.3f, 0)})
            plant.triangle_vertices.push_back({corner.x, corner.y, corner.z, t});
        plant.points.push_back({x, 0.0f, 0.0f, t});
        plant.point_owners.push_back(t);
    }
    return plant;
}

float side(const PlantBlocks& plant, uint32_t t) {
    return plant.triangle_vertices[3 * t + 1].x_plant - plant.triangle_vertices[3 * t].x_plant;
}

// Of what lanes do that draw groups of eight, the share that they wait: rows to be drawn go with the side.
double waiting(const PlantBlocks& plant) {
    double drawn = 0.0, taken = 0.0;
    for (uint32_t g = 0; g + k_triangles_a_lane_group <= k_count; g += k_triangles_a_lane_group) {
        float most = 0.0f;
        for (uint32_t t = g; t < g + k_triangles_a_lane_group; ++t) {
            drawn += double(side(plant, t));
            most = std::max(most, side(plant, t));
        }
        taken += double(most) * k_triangles_a_lane_group;
    }
    return 1.0 - drawn / taken;
}

TEST(GroupTriangles, LanesHardlyWait) {
    PlantBlocks plant = strewn_triangles();
    EXPECT_GT(waiting(plant), 0.35);
    group_triangles(plant);
    EXPECT_LT(waiting(plant), 0.1);
}

TEST(GroupTriangles, EachTriangleStaysInItsRunAndPointsFollow) {
    PlantBlocks plant = strewn_triangles();
    group_triangles(plant);
    std::set<uint32_t> seen;
    for (uint32_t t = 0; t < k_count; ++t) {
        const uint32_t was = plant.triangle_vertices[3 * t].surface;
        EXPECT_EQ(plant.triangle_vertices[3 * t + 2].surface, was);
        EXPECT_EQ(was / k_triangles_a_run, t / k_triangles_a_run);
        seen.insert(was);
    }
    EXPECT_EQ(seen.size(), k_count);
    for (uint32_t i = 0; i < k_count; ++i)
        EXPECT_EQ(plant.triangle_vertices[3 * plant.point_owners[i]].surface, i);
}

// Half of each run holds half of its area: large triangles do not come first.
TEST(GroupTriangles, PrefixesHoldTheirShareOfTheArea) {
    PlantBlocks plant = strewn_triangles();
    group_triangles(plant);
    for (uint32_t run = 0; run < 2; ++run) {
        double half = 0.0, all = 0.0;
        for (uint32_t i = 0; i < k_triangles_a_run; ++i) {
            const double area = double(side(plant, run * k_triangles_a_run + i));
            all += area;
            if (i < k_triangles_a_run / 2) half += area;
        }
        EXPECT_NEAR(half / all, 0.5, 0.1);
    }
}

TEST(GroupTriangles, CellsAreGroupedApart) {
    PlantBlocks plant = strewn_triangles();
    PackedPart cell{};
    cell.triangle_count = 100;
    plant.cells.push_back(cell);
    cell.first_triangle = 100;
    cell.triangle_count = k_count - 100;
    plant.cells.push_back(cell);
    group_triangles(plant);
    for (uint32_t t = 0; t < k_count; ++t)
        EXPECT_EQ(plant.triangle_vertices[3 * t].surface < 100u, t < 100u) << t;
}

TEST(GroupTriangles, NoneAndFewStayAsTheyAre) {
    PlantBlocks none;
    none.parts.push_back({});
    group_triangles(none);
    EXPECT_TRUE(none.triangle_vertices.empty());
    PlantBlocks one = strewn_triangles();
    one.triangle_vertices.resize(3), one.points.resize(1), one.point_owners.resize(1);
    one.parts[0].triangle_count = one.parts[0].point_count = 1;
    group_triangles(one);
    EXPECT_EQ(one.triangle_vertices[0].surface, 0u);
    EXPECT_EQ(one.point_owners[0], 0u);
}

}  // namespace
}  // namespace coppice
