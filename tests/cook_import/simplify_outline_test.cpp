#include "plugins/vegetation/cook/import/simplify_outline.h"
#include <gtest/gtest.h>
#include "plugins/vegetation/cook/import/triangulate_outline.h"

namespace coppice {
namespace {

// Blobs of a sum of waves, with holes.
AlphaGrid wavy_grid(uint32_t side, uint32_t seed) {
    AlphaGrid grid;
    for (uint32_t i = 0; i < side; ++i) {
        grid.xs.push_back(i);
        grid.ys.push_back(i);
    }
    float phase = float(seed);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            bool border = x == 0 || y == 0 || x + 1 == side || y + 1 == side;
            float value =
                portable_sin(float(x) * 0.21f + phase) * portable_cos(float(y) * 0.17f + phase * 2.0f) +
                0.5f * portable_sin(float(x + 2 * y) * 0.11f + phase);
            grid.values.push_back(border ? -1.0f : value);
        }
    return grid;
}

double area_of(const std::vector<Ring>& rings) {
    double area = 0.0;
    for (const Ring& ring : rings) area += signed_area(ring);
    return area;
}

double area_of(const FlatMesh& mesh, bool& all_positive) {
    double area = 0.0;
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        double twice = cross_at(mesh.corners[mesh.indices[t]], mesh.corners[mesh.indices[t + 1]],
                                mesh.corners[mesh.indices[t + 2]]);
        all_positive = all_positive && twice > 0.0;
        area += twice * 0.5;
    }
    return area;
}

TEST(SimplifyOutline, KeepsAreasAndTriangulates) {
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        auto rings = trace_outline(wavy_grid(80, seed), 0.2f);
        double area = area_of(rings);
        ASSERT_GT(area, 100.0);
        size_t before = 0, after = 0;
        for (const Ring& ring : rings) before += ring.size();
        OutlineLimits limits{0.05 * area, 1'000'000, dvec2(0.0), dvec2(79.0)};
        auto simple = simplify_outline(rings, limits);
        for (const Ring& ring : simple) after += ring.size();
        EXPECT_LT(after * 5, before) << seed;
        EXPECT_NEAR(area_of(simple) / area, 1.0, 1.0e-3) << seed;
        bool all_positive = true;
        double triangulated = area_of(triangulate_outline(simple), all_positive);
        EXPECT_TRUE(all_positive) << seed;
        EXPECT_NEAR(triangulated / area_of(simple), 1.0, 1.0e-6) << seed;
    }
}

TEST(SimplifyOutline, SquareWithHoleStaysWhatItIs) {
    std::vector<Ring> rings{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{4, 4}, {4, 6}, {6, 6}, {6, 4}}};
    auto simple = simplify_outline(rings, {0.0, 1'000'000, dvec2(0.0), dvec2(10.0)});
    ASSERT_EQ(simple.size(), 2u);
    EXPECT_EQ(simple[0].size(), 4u);
    EXPECT_EQ(simple[1].size(), 4u);
    FlatMesh mesh = triangulate_outline(simple);
    bool all_positive = true;
    EXPECT_DOUBLE_EQ(area_of(mesh, all_positive), 96.0);
    EXPECT_TRUE(all_positive);
    EXPECT_EQ(mesh.indices.size() / 3, 8u);
}

TEST(TraceOutline, DiagonalNeighboursAreJoinedByTheirMean) {
    AlphaGrid grid{{0, 1, 2, 3}, {0, 1, 2, 3}, {0, 0, 0, 0, 0, 9, 1, 0, 0, 1, 9, 0, 0, 0, 0, 0}};
    EXPECT_EQ(trace_outline(grid, 4.0f).size(), 1u);  // mean 5: one ring
    EXPECT_EQ(trace_outline(grid, 6.0f).size(), 2u);  // mean 5: two
}

}  // namespace
}  // namespace coppice
