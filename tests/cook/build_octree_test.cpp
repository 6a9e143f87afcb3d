#include "plugins/vegetation/cook/build_octree.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

struct Tree {
    std::vector<OctreeUnits> parts;
    Box bounds;

    void add(OctreeUnits units) {
        for (vec3 p : units.middle_plant) bounds.include(p);
        parts.push_back(std::move(units));
    }
};

// Units of that many triangles anywhere in a ball about (0, 6, 0).
OctreeUnits ball(uint32_t unit_count, float radius_m, uint64_t seed, uint32_t triangles_each = 1) {
    OctreeUnits units;
    Random random(seed);
    for (uint32_t i = 0; i < unit_count; ++i) {
        const vec3 outwards =
            shapes::random_direction(random);  // one after the other: operands have no order
        const float distance_m = radius_m * portable_pow(random.next_unit(), 1.0f / 3);
        units.middle_plant.push_back(vec3(0, 6, 0) + outwards * distance_m);
        units.triangle_count.push_back(triangles_each);
    }
    return units;
}

struct CellOfUnits {
    uint32_t triangle_count = 0;
    Box bounds;
};

// The cells of a part, after checking that their numbers have no gaps.
std::vector<CellOfUnits> cells_of(const OctreeUnits& units, const std::vector<uint32_t>& cell_of_unit) {
    EXPECT_EQ(cell_of_unit.size(), units.middle_plant.size());
    std::vector<CellOfUnits> cells;
    for (size_t u = 0; u < cell_of_unit.size(); ++u) {
        if (cell_of_unit[u] >= cells.size()) cells.resize(cell_of_unit[u] + 1);
        cells[cell_of_unit[u]].triangle_count += units.triangle_count[u];
        cells[cell_of_unit[u]].bounds.include(units.middle_plant[u]);
    }
    for (const CellOfUnits& cell : cells) EXPECT_GT(cell.triangle_count, 0u);
    return cells;
}

std::vector<CellOfUnits> cells_of(const Tree& tree, size_t part = 0, uint32_t limit = k_cell_limit) {
    const auto cell_of_unit = build_octree(tree.parts, tree.bounds, limit);
    EXPECT_EQ(cell_of_unit.size(), tree.parts.size());
    return cells_of(tree.parts[part], cell_of_unit[part]);
}

TEST(BuildOctree, CutsACrownIntoEight) {
    Tree tree;
    tree.add(ball(40000, 6.0f, 3));
    const auto cells = cells_of(tree);
    ASSERT_EQ(cells.size(), 8u) << "eight cells of 5000, which are not worth 64";
    uint32_t triangle_count = 0;
    for (const CellOfUnits& cell : cells) {
        triangle_count += cell.triangle_count;
        const vec3 size = cell.bounds.size();
        EXPECT_LT(std::max({size.x, size.y, size.z}), 6.1f) << "half the crown";
    }
    EXPECT_EQ(triangle_count, 40000u);
}

TEST(BuildOctree, CutsDenseCellsTwice) {
    Tree tree;
    tree.add(ball(160000, 8.0f, 5));
    const auto cells = cells_of(tree);
    EXPECT_GT(cells.size(), 16u);
    EXPECT_LE(cells.size(), size_t(k_cell_limit));
    uint32_t total = 0;
    for (const CellOfUnits& cell : cells) {
        total += cell.triangle_count;
        EXPECT_GE(cell.triangle_count, k_cell_least_triangles / 4) << "few ones join another";
        EXPECT_LT(glm::length(cell.bounds.size()), 16.0f);
    }
    EXPECT_EQ(total, 160000u);
}

TEST(BuildOctree, LeavesSmallAndSparsePlantsWhole) {
    for (float radius_m : {1.0f, 1.7f}) {  // 3 m is half the box's diagonal
        Tree small;
        small.add(ball(100000, radius_m, 3));
        EXPECT_EQ(cells_of(small).size(), 1u) << radius_m;
    }
    Tree sparse;
    sparse.add(ball(10000, 6.0f, 3));
    EXPECT_EQ(cells_of(sparse).size(), 1u) << "1250 triangles a cell";
    EXPECT_TRUE(build_octree({}, Box{}).empty());
    EXPECT_TRUE(build_octree(std::vector<OctreeUnits>(1), Box{})[0].empty());
    // A cell is no smaller than 2 m, however dense.
    Tree dense;
    dense.add(ball(200000, 3.5f, 3));
    EXPECT_EQ(cells_of(dense).size(), 8u);
}

TEST(BuildOctree, SmallPartsOfALargePlantStayWhole) {
    Tree tree;
    tree.add(ball(40000, 6.0f, 3));
    tree.add(ball(200, 6.0f, 4));
    EXPECT_EQ(cells_of(tree, 0).size(), 8u);
    EXPECT_EQ(cells_of(tree, 1).size(), 1u);
}

TEST(BuildOctree, UnitsOfManyTrianglesCountAsMany) {
    Tree tree;
    tree.add(ball(1000, 6.0f, 3, 40));
    EXPECT_EQ(cells_of(tree).size(), 8u);
}

TEST(BuildOctree, NeverMakesMoreCellsThanTheLimit) {
    Tree tree;
    for (uint64_t i = 0; i < 6; ++i) tree.add(ball(20000 + 2000 * uint32_t(i), 6.0f, i + 1));
    for (uint32_t limit : {6u, 12u, 13u, 20u, 64u}) {
        size_t count = 0;
        for (size_t part = 0; part < 6; ++part) count += cells_of(tree, part, limit).size();
        EXPECT_LE(count, limit);
        EXPECT_EQ(cells_of(tree, 5, limit).size(), limit >= 13 ? 8u : 1u) << "the largest comes first";
        EXPECT_EQ(cells_of(tree, 0, limit).size(), limit >= 48 ? 8u : 1u);
    }
}

TEST(BuildOctree, CutsFlatPlantsIntoSquares) {
    Tree tree;
    OctreeUnits carpet;
    Random random(1);
    for (int i = 0; i < 40000; ++i) {
        const float x = random.next_in(-5, 5);
        carpet.middle_plant.push_back(vec3(x, 0, random.next_in(-5, 5)));
        carpet.triangle_count.push_back(1);
    }
    tree.add(carpet);
    const auto cells = cells_of(tree);
    EXPECT_EQ(cells.size(), 16u);
    for (const CellOfUnits& cell : cells) EXPECT_LT(glm::length(cell.bounds.size()), 2.51f * 1.415f);
}

TEST(BuildOctree, LeavesAPileWhole) {
    Tree tree;
    OctreeUnits pile;
    pile.middle_plant.assign(40000, vec3(4, 7, 4));
    pile.triangle_count.assign(40000, 1);
    tree.add(pile);
    OctreeUnits outlier;
    outlier.middle_plant = {vec3(-9, 0, -9)};
    outlier.triangle_count = {2};
    tree.add(outlier);  // makes the plant large
    EXPECT_EQ(cells_of(tree, 0).size(), 1u);
    EXPECT_EQ(cells_of(tree, 1).size(), 1u);
}

TEST(BuildOctree, CutsWhatStandsInOneCornerOfThePlant) {
    Tree tree;
    OctreeUnits corner = ball(60000, 3.0f, 3);
    for (vec3& p : corner.middle_plant) p += vec3(5, 5, 5);
    tree.add(corner);
    OctreeUnits outlier;
    outlier.middle_plant = {vec3(-8, -2, -8)};
    outlier.triangle_count = {2};
    tree.add(outlier);
    EXPECT_GT(cells_of(tree, 0).size(), 1u);
}

}  // namespace
}  // namespace coppice
