#include "plugins/vegetation/cook/classify.h"

#include <gtest/gtest.h>
#include <numeric>
#include "plugins/vegetation/cook/closed_share.h"
#include "plugins/vegetation/cook/weld_positions.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

std::vector<SlenderPart> classify(PartDescription part, LineParts line_parts = LineParts::stems) {
    std::vector<uint32_t> welded = weld_positions(part.vertices);
    bool closed = closed_share(part, welded) >= k_closed_share;
    return classify_part(std::move(part), welded, closed, line_parts);
}

PartKind kind_of(PartDescription part, LineParts line_parts = LineParts::stems) {
    return classify(std::move(part), line_parts).at(0).part.kind;
}

PartDescription tube_of(float length_m, float radius_m) {
    PartDescription part;
    part.name = "bark";
    shapes::add_tube(part, shapes::straight_path(vec3(0), vec3(0, length_m, 0), 12),
                     std::vector<float>(12, radius_m));
    return part;
}

TEST(ClassifyPart, LeavesAndFruitsBecomePoints) {
    EXPECT_EQ(kind_of(shapes::leaf_cloud(200, 1, 0.1f, 1)), PartKind::points);
    EXPECT_EQ(kind_of(shapes::sphere(10, 20, 0.05f)), PartKind::points);
    EXPECT_EQ(kind_of(tube_of(1, 0.2f)), PartKind::points) << "a stump is not slender";
}

TEST(ClassifyPart, SlenderStemsBecomeLinesAndSlenderLeavesWhereAskedFor) {
    EXPECT_EQ(kind_of(tube_of(1, 0.02f)), PartKind::lines);
    PartDescription needles;
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        vec3 along = shapes::random_direction(random);
        shapes::add_quad(needles, shapes::random_direction(random), perpendicular_to(along) * 0.002f,
                         along * 0.05f);
    }
    EXPECT_EQ(kind_of(needles), PartKind::lines);
    needles.leaf = true;
    EXPECT_EQ(kind_of(needles), PartKind::points);
    EXPECT_EQ(kind_of(needles, LineParts::slender), PartKind::lines);
    EXPECT_EQ(kind_of(tube_of(1, 0.02f), LineParts::none), PartKind::points);
}

TEST(ClassifyPart, AFewTwigsAmongLeavesDoNotDecide) {
    PartDescription part = shapes::leaf_cloud(500, 1, 0.1f, 1);
    shapes::add_tube(part, shapes::straight_path(vec3(0), vec3(0, 1, 0), 5), std::vector<float>(5, 0.01f));
    EXPECT_EQ(kind_of(part), PartKind::points);
}

TEST(ClassifyPart, TheAuthorsWordAndASkeletonDecide) {
    PartDescription part = shapes::leaf_cloud(20, 1, 0.1f, 1);
    part.kind = PartKind::lines;
    EXPECT_EQ(kind_of(part), PartKind::lines);
    part = tube_of(1, 0.02f);
    part.kind = PartKind::points;
    EXPECT_EQ(kind_of(part), PartKind::points);
    part = tube_of(1, 0.2f);
    part.skeleton.push_back({vec3(0), vec3(0, 1, 0), 0.2f, 0.2f, 0, 0, vec3(0.1f)});
    EXPECT_EQ(kind_of(part), PartKind::lines);
}

TEST(ClassifyPart, BarkInOnePieceIsSplitByThicknessAndNothingIsLost) {
    PartDescription bark = tube_of(4, 0.2f);
    Random random(9);
    for (int i = 0; i < 30; ++i) {
        vec3 from(0, random.next_in(1, 4), 0);
        shapes::add_tube(bark, shapes::straight_path(from, from + shapes::random_direction(random), 6),
                         std::vector<float>(6, 0.02f), 6);
        shapes::add_tube(
            bark, shapes::straight_path(from * 1.5f, from * 1.5f + shapes::random_direction(random), 6),
            std::vector<float>(6, 0.003f), 4);
    }
    size_t triangle_count = bark.indices.size() / 3;
    std::vector<SlenderPart> pieces = classify(bark);
    ASSERT_EQ(pieces.size(), 3u);
    EXPECT_EQ(pieces[0].part.name, "bark");
    EXPECT_EQ(pieces[1].part.name, "bark/4");
    EXPECT_EQ(pieces[2].part.name, "bark/16");
    size_t sum = 0;
    for (const SlenderPart& piece : pieces) {
        sum += piece.part.indices.size() / 3;
        ASSERT_EQ(piece.skeleton.triangle_segment.size(), piece.part.indices.size() / 3);
        for (uint32_t segment : piece.skeleton.triangle_segment)
            ASSERT_LT(segment, piece.skeleton.segments.size());
        for (uint32_t index : piece.part.indices) ASSERT_LT(index, piece.part.vertices.size());
    }
    EXPECT_EQ(sum, triangle_count);
    EXPECT_EQ(pieces[0].part.indices.size() / 3, 11u * 16);
    EXPECT_EQ(pieces[1].part.indices.size() / 3, 30u * 60);
}

TEST(ClassifyPart, ATaperingTrunkIsSplitAlongItself) {
    PartDescription trunk;
    trunk.name = "trunk";
    std::vector<float> radii;
    for (int i = 0; i < 60; ++i) radii.push_back(0.3f * (1 - float(i) / 62));
    shapes::add_tube(trunk, shapes::straight_path(vec3(0), vec3(0, 8, 0), 60), radii, 10);
    std::vector<SlenderPart> pieces = classify(trunk);
    ASSERT_EQ(pieces.size(), 2u);
    for (const SlenderPart& piece : pieces) {
        float least = INFINITY, most = 0;
        for (const SkeletonSegment& s : piece.skeleton.segments) {
            least = std::min(least, 0.5f * (s.begin_radius_m + s.end_radius_m));
            most = std::max(most, 0.5f * (s.begin_radius_m + s.end_radius_m));
        }
        EXPECT_LT(most, 4.5f * least) << piece.part.name;
    }
}

}  // namespace
}  // namespace coppice
