#include "plugins/vegetation/cook/clean_mesh.h"

#include <gtest/gtest.h>
#include "plugins/vegetation/cook/closed_share.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

PartDescription clean(const PartDescription& part, CleanCounts& counts) {
    auto cleaned = clean_mesh(part, "test", "parts[0]", counts);
    if (!cleaned) {
        ADD_FAILURE() << to_string(cleaned.error());
        return {};
    }
    return std::move(*cleaned);
}

ErrorId refused(const PartDescription& part) {
    CleanCounts counts;
    auto cleaned = clean_mesh(part, "test", "parts[0]", counts);
    if (cleaned) return ErrorId::inconclusive;
    EXPECT_EQ(cleaned.error().place, "parts[0]");
    return cleaned.error().id;
}

TEST(CleanMesh, DropsAndCountsTrianglesWithoutArea) {
    PartDescription part;
    vec3 a(0), b(1, 0, 0), c(0, 1, 0);
    shapes::add_triangle(part, a, b, c);
    shapes::add_triangle(part, a, b, b);         // repeated corner
    shapes::add_triangle(part, a, a, a);         // one place
    shapes::add_triangle(part, a, b, b * 2.0f);  // on a line
    shapes::add_triangle(part, a, b, vec3(NAN, 0, 0));
    shapes::add_triangle(part, a, b, vec3(0, INFINITY, 0));
    shapes::add_triangle(part, a, vec3(1e-30f, 0, 0), vec3(0, 1e-30f, 0));
    shapes::add_vertex(part, c, vec3(0, 1, 0));  // used by nothing
    CleanCounts counts;
    PartDescription cleaned = clean(part, counts);
    EXPECT_EQ(cleaned.indices.size(), 3u);
    EXPECT_EQ(cleaned.vertices.size(), 3u);
    EXPECT_EQ(counts.dropped_triangles, 6u);
    EXPECT_EQ(counts.dropped_vertices, 6u * 3 + 1);
}

TEST(CleanMesh, RefusesWhatIsFurtherThanAnyPlant) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(1, 0, 0), vec3(0, k_position_limit_m, 0));
    CleanCounts counts;
    EXPECT_EQ(clean(part, counts).indices.size(), 3u);
    part.vertices[2].position_plant.y *= 1.001f;
    EXPECT_EQ(refused(part), ErrorId::value_out_of_range);
    EXPECT_EQ(counts.dropped_triangles, 0u);
}

TEST(CleanMesh, KeepsSmallTrianglesThatHaveAnArea) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(1e-5f, 0, 0), vec3(0, 1e-5f, 0));
    shapes::add_triangle(part, vec3(0), vec3(1, 0, 0), vec3(0.5f, 1e-4f, 0));
    CleanCounts counts;
    EXPECT_EQ(clean(part, counts).indices.size(), 6u);
}

TEST(CleanMesh, RepairsNormalsAndColors) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(0, 0, 1), vec3(1, 0, 0));
    part.vertices[0].normal_plant = vec3(0, 5, 0);
    part.vertices[1].normal_plant = vec3(NAN, 0, 0);
    part.vertices[2].normal_plant = vec3(0);
    part.vertices[0].color_linear = vec3(-1, 2, NAN);
    CleanCounts counts;
    PartDescription cleaned = clean(part, counts);
    for (const DescriptionVertex& v : cleaned.vertices) EXPECT_EQ(v.normal_plant, vec3(0, 1, 0));
    EXPECT_EQ(cleaned.vertices[0].color_linear, vec3(0, 1, 0.5f));
}

TEST(CleanMesh, MovesElementRangesWithWhatIsDropped) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    shapes::add_triangle(part, vec3(0), vec3(0), vec3(0, 1, 0));
    shapes::add_triangle(part, vec3(0), vec3(1, 0, 0), vec3(0, 0, 1));
    part.element_first_triangle = {0, 2, 3};
    CleanCounts counts;
    EXPECT_EQ(clean(part, counts).element_first_triangle, (std::vector<uint32_t>{0, 1, 2}));
}

TEST(CleanMesh, RefusesWhatDoesNotFitTogether) {
    PartDescription good;
    shapes::add_triangle(good, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    PartDescription part = good;
    part.indices[1] = 3;
    EXPECT_EQ(refused(part), ErrorId::value_out_of_range);
    part = good;
    part.indices.push_back(0);
    EXPECT_EQ(refused(part), ErrorId::value_out_of_range);
    for (std::vector<uint32_t> ranges : {std::vector<uint32_t>{1}, {0, 2}, {0, 5, 1}, {0}}) {
        part = good;
        part.element_first_triangle = ranges;
        EXPECT_EQ(refused(part), ErrorId::value_out_of_range);
    }
    for (float importance : {-1.0f, NAN, INFINITY}) {
        part = good;
        part.importance = importance;
        EXPECT_EQ(refused(part), ErrorId::value_out_of_range);
    }
    EXPECT_EQ(refused(good), ErrorId::inconclusive) << "the good one is taken";
}

TEST(CleanMesh, DropsSkeletonSegmentsWithoutLength) {
    PartDescription part;
    shapes::add_triangle(part, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    part.skeleton.push_back({vec3(0), vec3(0), 1, 1, 0, 0, vec3(0)});
    part.skeleton.push_back({vec3(0), vec3(0, NAN, 0), 1, 1, 0, 0, vec3(0)});
    part.skeleton.push_back({vec3(0), vec3(0, 1, 0), -1, NAN, 0, 0, vec3(7)});
    CleanCounts counts;
    PartDescription cleaned = clean(part, counts);
    ASSERT_EQ(cleaned.skeleton.size(), 1u);
    EXPECT_EQ(cleaned.skeleton[0].begin_radius_m, 0.0f);
    EXPECT_EQ(cleaned.skeleton[0].end_radius_m, 0.0f);
    EXPECT_EQ(cleaned.skeleton[0].color_linear, vec3(1));
}

TEST(WeldPositions, JoinsSeamsThatWereRoundedDifferently) {
    PartDescription part;
    shapes::add_vertex(part, vec3(10, 0, 0), vec3(0, 1, 0));
    shapes::add_vertex(part, vec3(0), vec3(0, 1, 0));
    shapes::add_vertex(part, vec3(10.000001f, 0, 0), vec3(1, 0, 0));
    shapes::add_vertex(part, vec3(-0.0f), vec3(1, 0, 0));
    shapes::add_vertex(part, vec3(10.0005f, 0, 0), vec3(1, 0, 0));
    EXPECT_EQ(weld_positions(part.vertices), (std::vector<uint32_t>{0, 1, 0, 1, 4}));
}

TEST(ClosedShare, TellsTubesAndFruitsFromLeaves) {
    PartDescription tube;
    shapes::add_tube(tube, shapes::straight_path(vec3(0), vec3(0, 1, 0), 12), std::vector<float>(12, 0.05f));
    EXPECT_GE(closed_share(tube, weld_positions(tube.vertices)), k_closed_share);
    PartDescription ball = shapes::sphere(12, 24, 1);
    EXPECT_GT(closed_share(ball, weld_positions(ball.vertices)), 0.999f);
    PartDescription leaves = shapes::leaf_cloud(100, 1, 0.1f, 1);
    EXPECT_LT(closed_share(leaves, weld_positions(leaves.vertices)), 0.5f);
    PartDescription sheet;
    shapes::add_quad(sheet, vec3(0), vec3(1, 0, 0), vec3(0, 0, 1));
    shapes::add_quad(sheet, vec3(2, 0, 0), vec3(1, 0, 0), vec3(0, 0, 1));
    EXPECT_EQ(closed_share(sheet, weld_positions(sheet.vertices)) >= k_closed_share, false);
    EXPECT_EQ(closed_share(PartDescription{}, {}), 0.0f);
}

}  // namespace
}  // namespace coppice
