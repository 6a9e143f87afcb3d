#include "plugins/vegetation/cook/trace_lines.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "plugins/vegetation/cook/weld_positions.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

TracedLines trace(const PartDescription& part) {
    return trace_lines(part, part.skeleton.empty() ? trace_skeleton(part, weld_positions(part.vertices))
                                                   : adopt_skeleton(part));
}

float cone_inside(vec3 p, vec3 a, vec3 b, float ra, float rb) {
    vec3 along = b - a;
    float share = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0f, 1.0f);
    return ra + (rb - ra) * share - distance_to_segment(p, a, b);
}

TEST(TraceLines, ATubeIsItsAxis) {
    PartDescription tube;
    shapes::add_tube(tube, shapes::straight_path(vec3(1, 0, 2), vec3(1, 3, 2), 16),
                     std::vector<float>(16, 0.05f), 12);
    TracedLines traced = trace(tube);
    EXPECT_NEAR(traced.length_m, 3.0f, 0.01f);
    EXPECT_NEAR(traced.error_m, 0.05f, 0.001f);
    for (const TracedLine& line : traced.lines)
        for (vec3 end : {line.begin_plant, line.end_plant})
            EXPECT_LT(distance_to_segment(end, vec3(1, 0, 2), vec3(1, 3, 2)), 1e-3f);
}

TEST(TraceLines, ABentTubeIsFollowed) {
    PartDescription tube;
    std::vector<vec3> path;
    for (int i = 0; i <= 40; ++i) {
        float around = k_pi * float(i) / 40;
        path.push_back(vec3(portable_cos(around), portable_sin(around), 0));
    }
    shapes::add_tube(tube, path, std::vector<float>(path.size(), 0.02f), 6);
    TracedLines traced = trace(tube);
    EXPECT_NEAR(traced.length_m, k_pi, 0.03f);
    EXPECT_LT(traced.error_m, 0.032f);
    EXPECT_LT(traced.lines.size(), 40u) << "few lines";
    EXPECT_GT(traced.lines.size(), 5u) << "but it bends";
}

TEST(TraceLines, EveryTubeOfManyGetsItsOwnLine) {
    PartDescription twigs;
    Random random(3);
    float length = 0;
    for (int i = 0; i < 200; ++i) {
        vec3 from(random.next_in(-2, 2), random.next_in(-2, 2), random.next_in(-2, 2));
        float l = random.next_in(0.2f, 0.5f);
        length += l;
        shapes::add_tube(twigs, shapes::straight_path(from, from + shapes::random_direction(random) * l, 5),
                         std::vector<float>(5, 0.004f), 4);
    }
    TracedLines traced = trace(twigs);
    EXPECT_NEAR(traced.length_m, length, 0.01f * length);
    EXPECT_NEAR(traced.error_m, 0.004f, 0.0005f);
    EXPECT_GE(traced.lines.size(), 200u);
    EXPECT_LE(traced.lines.size(), twigs.indices.size() / 3 * 2 / 3);
}

TEST(TraceLines, ABranchedSkinIsFollowedIntoItsBranches) {
    auto inside = [](vec3 p) {
        return std::max({cone_inside(p, vec3(0, 0, 0), vec3(0, 2, 0), 0.08f, 0.06f),
                         cone_inside(p, vec3(0, 1, 0), vec3(0.9f, 1.7f, 0.1f), 0.06f, 0.05f),
                         cone_inside(p, vec3(0, 1.3f, 0), vec3(-0.7f, 1.9f, -0.4f), 0.06f, 0.05f)});
    };
    Box box;
    box.include(vec3(-0.9f, -0.2f, -0.6f));
    box.include(vec3(1.1f, 2.2f, 0.4f));
    PartDescription skin = shapes::skin_of(inside, box, 0.031f);
    TracedLines traced = trace(skin);
    EXPECT_LT(traced.error_m, 0.13f) << "about the radius, more in the forks";
    // 2 m of trunk, 1.14 m and 1.0 m of branches; lines end where the skin ends and begin at the trunk's
    // axis.
    EXPECT_NEAR(traced.length_m, 4.2f, 0.5f);
    auto nearest_end = [&](vec3 place) {
        float nearest = INFINITY;
        for (const TracedLine& line : traced.lines)
            nearest = std::min(nearest, distance_to_segment(place, line.begin_plant, line.end_plant));
        return nearest;
    };
    for (vec3 tip : {vec3(0, 2, 0), vec3(0.9f, 1.7f, 0.1f), vec3(-0.7f, 1.9f, -0.4f), vec3(0, 0.05f, 0)})
        EXPECT_LT(nearest_end(tip), 0.1f);
}

TEST(TraceLines, ABladeOfGrassIsItsMiddleAndFacesItsWay) {
    PartDescription blade;
    for (int i = 0; i < 6; ++i) {
        float y = 0.1f * float(i), next = y + 0.1f, width = 0.01f * (1 - y / 0.65f),
              next_width = 0.01f * (1 - next / 0.65f);
        vec3 a(-width / 2, y, 0), b(width / 2, y, 0), c(-next_width / 2, next, 0), d(next_width / 2, next, 0);
        shapes::add_triangle(blade, a, b, d);
        shapes::add_triangle(blade, a, d, c);
    }
    TracedLines traced = trace(blade);
    EXPECT_NEAR(traced.length_m, 0.6f, 0.01f);
    EXPECT_LT(traced.error_m, 0.007f);
    for (const TracedLine& line : traced.lines) EXPECT_GT(std::fabs(line.normal_plant.z), 0.99f);
}

TEST(TraceLines, ANeedleOfTwoTrianglesIsOneLine) {
    PartDescription needle;
    shapes::add_quad(needle, vec3(0), vec3(0.001f, 0, 0), vec3(0, 0.03f, 0.04f));
    TracedLines traced = trace(needle);
    ASSERT_EQ(traced.lines.size(), 1u);
    EXPECT_NEAR(traced.length_m, 0.05f, 0.002f);
    EXPECT_LT(traced.error_m, 0.0015f);
}

TEST(TraceLines, TheModellersSkeletonIsTakenAsItIs) {
    PartDescription part;
    std::vector<vec3> path{vec3(0), vec3(0, 1, 0), vec3(0.2f, 2, 0)};
    shapes::add_tube(part, path, {0.1f, 0.08f, 0.06f}, 8);
    vec3 brown(0.2f, 0.1f, 0.05f);
    part.skeleton.push_back({path[0], path[1], 0.1f, 0.08f, 0, 0, brown});
    part.skeleton.push_back({path[1], path[2], 0.08f, 0.06f, 0, 0, brown});
    TracedSkeleton skeleton = adopt_skeleton(part);
    ASSERT_EQ(skeleton.triangle_segment.size(), 32u);
    for (uint32_t t = 0; t < 32; ++t) EXPECT_EQ(skeleton.triangle_segment[t], t / 16);
    TracedLines traced = trace_lines(part, skeleton);
    EXPECT_NEAR(traced.length_m, 1 + std::sqrt(1.04f), 1e-4f);
    EXPECT_NEAR(traced.largest_error_m, 0.1f, 0.01f);
    EXPECT_LE(traced.error_m, traced.largest_error_m);
}

TEST(TraceLines, CrossingTwigsKeepTheirTriangles) {
    PartDescription part;
    Random random(12);
    std::vector<uint32_t> expected;
    for (uint32_t i = 0; i < 60; ++i) {
        vec3 direction = shapes::random_direction(random), from = direction * -0.5f;
        float radius = random.next_in(0.005f, 0.02f);
        shapes::add_tube(part, shapes::straight_path(from, from + direction, 2), {radius, radius}, 5);
        part.skeleton.push_back({from, from + direction, radius, radius, i, 1, vec3(0.1f)});
        expected.insert(expected.end(), 10, i);
    }
    EXPECT_EQ(adopt_skeleton(part).triangle_segment, expected);
}

TEST(TraceLines, TakesAnySurfaceWithoutFailing) {
    // Not slender at all: what comes out need not be good, but every triangle has a segment and all is
    // finite.
    PartDescription strange = shapes::sphere(9, 14, 0.3f);
    shapes::add_triangle(strange, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    PartDescription cloud = shapes::leaf_cloud(50, 0.05f, 0.1f, 3);
    for (uint32_t index : cloud.indices) {
        const DescriptionVertex& v = cloud.vertices[index];
        strange.indices.push_back(shapes::add_vertex(strange, v.position_plant, v.normal_plant));
    }
    // Three triangles on one edge.
    for (int i = 0; i < 3; ++i)
        shapes::add_triangle(strange, vec3(5), vec3(5, 6, 5), vec3(5 + float(i % 2), 5, 5 + float(i)));
    TracedSkeleton skeleton = trace_skeleton(strange, weld_positions(strange.vertices));
    ASSERT_EQ(skeleton.triangle_segment.size(), strange.indices.size() / 3);
    for (uint32_t segment : skeleton.triangle_segment) ASSERT_LT(segment, skeleton.segments.size());
    for (const SkeletonSegment& s : skeleton.segments) {
        ASSERT_TRUE(is_finite(s.begin_plant) && is_finite(s.end_plant));
        ASSERT_GT(s.begin_radius_m + s.end_radius_m, 0.0f);
    }
    TracedLines traced = trace_lines(strange, skeleton);
    EXPECT_TRUE(std::isfinite(traced.error_m) && std::isfinite(traced.length_m));
}

}  // namespace
}  // namespace coppice
