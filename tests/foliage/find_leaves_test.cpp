#include "plugins/vegetation/cook/find_leaves.h"

#include <gtest/gtest.h>
#include "plugins/vegetation/cook/clean_mesh.h"
#include "plugins/vegetation/cook/triangle_areas.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

FoundLeaves find(const PartDescription& part, uint32_t expected_dropped = 0) {
    CleanCounts dropped;
    const Result<PartDescription> clean = clean_mesh(part, "test", "parts[0]", dropped);
    EXPECT_TRUE(clean.has_value());
    EXPECT_EQ(dropped.dropped_triangles, expected_dropped);
    FoundLeaves found = find_leaves(*clean, weld_positions(clean->vertices));
    const LeafCounts& c = found.counts;
    EXPECT_EQ(c.quads + c.triangles + c.meshes, found.leaves.size());
    return found;
}

vec3 facing_of(const Leaf& leaf) {
    const auto& p = leaf.corners_plant;
    return normalize_or(glm::cross(p[2] - p[0], p[3] - p[1]), vec3(0));
}

vec3 middle_of(const Leaf& leaf) {
    const auto& p = leaf.corners_plant;
    return (p[0] + p[1] + p[2] + p[3]) * 0.25f;
}

// A flat leaf of many triangles: a fan over an ellipse in the plane of u and v.
void add_ellipse(PartDescription& part, vec3 center, vec3 u, vec3 v, int triangle_count, vec3 color) {
    auto rim = [&](int i) {
        const float around = 2 * k_pi * float(i % triangle_count) / float(triangle_count);
        return center + u * portable_cos(around) + v * portable_sin(around);
    };
    for (int i = 0; i < triangle_count; ++i) shapes::add_triangle(part, center, rim(i), rim(i + 1), color);
}

TEST(FindLeaves, QuadsStayAsTheyAre) {
    PartDescription part;
    for (int i = 0; i < 5; ++i)
        shapes::add_quad(part, vec3(float(i), 0, 0), vec3(0.1f, 0.02f, 0), vec3(0, 0.05f, 0.3f),
                         vec3(0.1f * float(i)));
    const FoundLeaves found = find(part);
    ASSERT_EQ(found.counts.quads, 5u);
    EXPECT_EQ(found.counts.largest_leaf_triangles, 2u);
    for (int i = 0; i < 5; ++i) {
        const Leaf& leaf = found.leaves[size_t(i)];
        const vec3 corner(float(i), 0, 0), u(0.1f, 0.02f, 0), v(0, 0.05f, 0.3f);
        for (vec3 expected : {corner, corner + u, corner + u + v, corner + v})
            EXPECT_EQ(std::count(leaf.corners_plant.begin(), leaf.corners_plant.end(), expected), 1);
        EXPECT_GT(glm::dot(facing_of(leaf), normalize_or(glm::cross(u, v), vec3(0))), 0.9999f);
        EXPECT_GT(glm::dot(leaf.normal_plant, facing_of(leaf)), 0.9999f);
        EXPECT_NEAR(leaf.color_linear.x, 0.1f * float(i), 1e-6f);
        EXPECT_NEAR(leaf_area_m2(leaf), double(glm::length(glm::cross(u, v))), 1e-7);
    }
}

TEST(FindLeaves, SingleTrianglesKeepTheirShape) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(0.3f, 0, 0), vec3(0.1f, 0, -0.1f));
    const FoundLeaves found = find(part);
    ASSERT_EQ(found.counts.triangles, 1u);
    EXPECT_NEAR(leaf_area_m2(found.leaves[0]), 0.015, 1e-8);
    EXPECT_GT(facing_of(found.leaves[0]).y, 0.9999f);
    for (vec3 corner : found.leaves[0].corners_plant) EXPECT_EQ(corner.y, 0.0f);
}

TEST(FindLeaves, AnyMeshGetsAProxyOfItsAreaMiddleNormalAndColor) {
    Random random(2);
    for (int triangle_count : {3, 8, 300}) {
        PartDescription part;
        const vec3 normal = shapes::random_direction(random), u = perpendicular_to(normal);
        const vec3 center = shapes::random_direction(random) * 3.0f;
        add_ellipse(part, center, u * 0.2f, glm::cross(normal, u) * 0.05f, triangle_count,
                    vec3(0.1f, 0.2f, 0.05f));
        const FoundLeaves found = find(part);
        ASSERT_EQ(found.counts.meshes, 1u);
        EXPECT_EQ(found.counts.closed, 0u);
        EXPECT_EQ(found.counts.largest_leaf_triangles, uint32_t(triangle_count));
        const Leaf& leaf = found.leaves[0];
        const auto [area_m2, color] = measure_area_and_color(part);
        EXPECT_NEAR(leaf_area_m2(leaf) / area_m2, 1.0, 1e-4);
        EXPECT_GT(glm::dot(facing_of(leaf), normal), 0.9999f);
        EXPECT_GT(glm::dot(leaf.normal_plant, normal), 0.9999f);
        EXPECT_LT(glm::length(middle_of(leaf) - center), 1e-3f);
        EXPECT_LT(glm::length(leaf.color_linear - color), 1e-5f);
        // The long way is the ellipse's.
        if (triangle_count > 3) {
            const vec3 along = leaf.corners_plant[2] - leaf.corners_plant[0];
            EXPECT_GT(std::fabs(glm::dot(along, u)) / glm::length(along), 0.999f);
        }
    }
}

TEST(FindLeaves, ABentLeafsProxyIsBentAsItIs) {
    for (float rise : {-0.05f, 0.05f}) {
        PartDescription part;  // two wings of four triangles each, 45 degrees from the middle plane
        for (int i = 0; i < 2; ++i) {
            const vec3 along(0.2f, 0, 0), start(0.2f * float(i), 0, 0);
            shapes::add_quad(part, start, along, vec3(0, rise, -0.05f));
            shapes::add_quad(part, start + vec3(0, rise, 0.05f), along, vec3(0, -rise, -0.05f));
        }
        const FoundLeaves found = find(part);
        ASSERT_EQ(found.counts.meshes, 1u);
        const Leaf& leaf = found.leaves[0];
        const auto& p = leaf.corners_plant;
        EXPECT_NEAR(leaf_area_m2(leaf) / measure_area_and_color(part).first, 1.0, 1e-4);
        EXPECT_GT(std::fabs(facing_of(leaf).y), 0.9999f);
        const vec3 n0 = normalize_or(glm::cross(p[1] - p[0], p[2] - p[0]), vec3(0));
        const vec3 n1 = normalize_or(glm::cross(p[2] - p[0], p[3] - p[0]), vec3(0));
        EXPECT_NEAR(std::fabs(n0.y), std::sqrt(0.5f), 1e-3f);
        EXPECT_NEAR(glm::dot(n0, n1), 0.0f, 1e-3f);
        EXPECT_NEAR(std::fabs(n0.x), 0.0f, 1e-3f);
        // Its wings are where the leaf's are.
        EXPECT_GT((p[1].y - p[0].y) * rise, 0.0f);
        EXPECT_NEAR((p[0].y + p[1].y + p[2].y) / 3.0f, 0.5f * rise, 1e-4f);
    }
}

TEST(FindLeaves, WhatTheAuthorToldApartStaysApart) {
    PartDescription part;  // two quads with a corner in common
    shapes::add_quad(part, vec3(0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f));
    shapes::add_quad(part, vec3(0), vec3(-0.1f, 0, 0), vec3(0, 0, -0.1f));
    EXPECT_EQ(find(part).counts.meshes, 1u);
    part.element_first_triangle = {0, 2, 4};
    EXPECT_EQ(find(part).counts.quads, 2u);
}

TEST(FindLeaves, RepeatedSurfacesCountOnce) {
    PartDescription part;
    for (int copy = 0; copy < 50; ++copy) shapes::add_quad(part, vec3(0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f));
    FoundLeaves found = find(part);
    ASSERT_EQ(found.leaves.size(), 1u);
    EXPECT_EQ(found.counts.repeated_triangles, 98u);
    EXPECT_NEAR(leaf_area_m2(found.leaves[0]), 0.01, 1e-8);

    for (uint32_t i = 0; i <= 50; ++i) part.element_first_triangle.push_back(2 * i);
    found = find(part);
    ASSERT_EQ(found.leaves.size(), 1u);
    EXPECT_EQ(found.counts.repeated_leaves, 49u);

    // The back of a leaf as a second face, cut along the other diagonal.
    PartDescription two_sided;
    shapes::add_quad(two_sided, vec3(0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f));
    shapes::add_quad(two_sided, vec3(0.1f, 0, 0), vec3(-0.1f, 0, 0), vec3(0, 0, 0.1f));
    found = find(two_sided);
    ASSERT_EQ(found.leaves.size(), 1u);
    EXPECT_EQ(found.counts.closed, 1u);
    EXPECT_NEAR(leaf_area_m2(found.leaves[0]), 0.01, 1e-7);
    EXPECT_GT(std::fabs(facing_of(found.leaves[0]).y), 0.9999f);
}

TEST(FindLeaves, ClosedLeavesCoverHalfTheirArea) {
    const PartDescription part = shapes::sphere(12, 16, 0.1f);
    const FoundLeaves found = find(part);
    ASSERT_EQ(found.counts.closed, 1u);
    EXPECT_NEAR(leaf_area_m2(found.leaves[0]) / measure_area_and_color(part).first, 0.5, 1e-4);
    EXPECT_LT(glm::length(middle_of(found.leaves[0])), 1e-3f);
}

TEST(FindLeaves, LeavesWithoutAreaAreCountedAndTheOthersKept) {
    PartDescription part;
    shapes::add_quad(part, vec3(0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f));
    shapes::add_triangle(part, vec3(1, 0, 0), vec3(1, 0, 0), vec3(1, 0, 0));         // one point
    shapes::add_triangle(part, vec3(2, 0, 0), vec3(2, 1, 0), vec3(2, 1, 0));         // coincident corners
    shapes::add_triangle(part, vec3(3, 0, 0), vec3(3, 1, 0), vec3(3, 2, 0));         // on one line
    shapes::add_triangle(part, vec3(NAN, 0, 0), vec3(3, 1, 0), vec3(3, 2, 1));       // not a number
    shapes::add_triangle(part, vec3(4, 0, 0), vec3(4, 1, 0), vec3(4, 0.5f, 1e-5f));  // a sliver has area
    const FoundLeaves found = find(part, 4);
    EXPECT_EQ(found.leaves.size(), 2u);
    for (const Leaf& leaf : found.leaves) {
        EXPECT_GT(leaf_area_m2(leaf), 0.0);
        for (vec3 corner : leaf.corners_plant) EXPECT_TRUE(is_finite(corner));
    }
    EXPECT_TRUE(find_leaves({}, {}).leaves.empty());
}

TEST(FindLeaves, AFoldedLeafHasAFiniteProxy) {
    PartDescription part;  // three faces of nearly opposite normals: no mean normal
    shapes::add_triangle(part, vec3(0), vec3(0.1f, 0, 0), vec3(0, 0, 0.1f));
    shapes::add_triangle(part, vec3(0), vec3(0, 0.001f, 0.1f), vec3(0.1f, 0, 0));
    shapes::add_triangle(part, vec3(0), vec3(0.001f, 0, 0.001f), vec3(0, 0, 0.1f));
    const FoundLeaves found = find(part);
    ASSERT_EQ(found.leaves.size(), 1u);
    EXPECT_NEAR(leaf_area_m2(found.leaves[0]) / measure_area_and_color(part).first, 1.0, 1e-3);
    EXPECT_NEAR(glm::length(found.leaves[0].normal_plant), 1.0f, 1e-4f);
}

}  // namespace
}  // namespace coppice
