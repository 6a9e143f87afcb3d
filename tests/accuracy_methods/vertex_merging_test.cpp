#include "tools/accuracy/vertex_merging.h"

#include <cstring>
#include "plugins/vegetation/cook/cook_plant.h"
#include "tests/accuracy_methods/packed_shapes.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

using shapes::packed_plant;
using shapes::packed_vertex;
using shapes::place_of;

// A square of 4 by 4 unit cells in the xz plane, two triangles each.
Plant grid_plant() {
    std::vector<PackedVertex> corners;
    for (int x = 0; x < 4; ++x)
        for (int z = 0; z < 4; ++z) {
            const vec3 a(float(x), 0, float(z)), u(1, 0, 0), v(0, 0, 1);
            for (vec3 p : {a, a + u, a + u + v, a, a + u + v, a + v}) corners.push_back(packed_vertex(p));
        }
    return packed_plant({corners});
}

Plant merged(const Plant& plant, float cell_m) {
    auto result = merge_vertices(plant, cell_m);
    EXPECT_TRUE(result) << to_string(result.error());
    return std::move(*result);
}

size_t triangle_count(const Plant& plant) { return plant.triangle_vertices.size() / 3; }

double area_m2(const Plant& plant) {
    double area = 0.0;
    for (const PackedPart& part : plant.parts) area += double(part.area_m2);
    return area;
}

TEST(VertexMerging, CellsSmallerThanEdgesChangeNothing) {
    const Plant grid = grid_plant(), same = merged(grid, 0.5f);
    ASSERT_EQ(triangle_count(same), 32u);
    for (size_t i = 0; i < grid.triangle_vertices.size(); ++i)
        EXPECT_EQ(place_of(same.triangle_vertices[i]), place_of(grid.triangle_vertices[i]));
    EXPECT_NEAR(area_m2(same), 16.0, 1e-5);
}

// Cells of side 2 from the corner: columns of vertices {0, 1}, {2, 3}, {4} along both axes, so 3 by 3
// representatives with 2 by 2 squares between them: 8 triangles.
TEST(VertexMerging, AGridBecomesACoarserGrid) {
    const Plant coarse = merged(grid_plant(), 2.0f);
    EXPECT_EQ(triangle_count(coarse), 8u);
    std::vector<vec3> places;
    for (const PackedVertex& v : coarse.triangle_vertices)
        if (std::find(places.begin(), places.end(), place_of(v)) == places.end())
            places.push_back(place_of(v));
    EXPECT_EQ(places.size(), 9u);
    // The last cell holds the corner of the square alone.
    EXPECT_NE(std::find(places.begin(), places.end(), vec3(4, 0, 4)), places.end());
    for (vec3 p : places) EXPECT_TRUE(p.x >= 0 && p.x <= 4 && p.y == 0 && p.z >= 0 && p.z <= 4);
}

TEST(VertexMerging, ARepresentativeIsTheMeanByArea) {
    // Two triangles that share no vertex; their corners near the origin fall into one cell.
    const std::vector<PackedVertex> corners{
        packed_vertex({0, 0, 0}, {0, 1, 0}, vec3(0)),
        packed_vertex({8, 0, 0}),
        packed_vertex({8, 2, 0}),  // 8 m2
        packed_vertex({0.9f, 0, 0}, {0, 1, 0}, vec3(1)),
        packed_vertex({2.9f, 0, 0}),
        packed_vertex({2.9f, 2, 0}),  // 2 m2
    };
    const Plant plant = merged(packed_plant({corners}), 1.0f);
    ASSERT_EQ(triangle_count(plant), 2u);
    EXPECT_NEAR(plant.triangle_vertices[0].x_plant, 0.2f * 0.9f, 1e-6f);
    EXPECT_EQ(place_of(plant.triangle_vertices[3]), place_of(plant.triangle_vertices[0]));
    EXPECT_NEAR(decode_surface(plant.triangle_vertices[0].surface).color_linear.y, 0.2f, 0.03f);
}

TEST(VertexMerging, DropsTrianglesThatCollapseAndSecondOnesOfAPair) {
    const vec3 a(0), b(4, 0, 0), c(0, 4, 0), bit(0.1f, 0.1f, 0);
    const std::vector<PackedVertex> corners{
        packed_vertex(a),       packed_vertex(b),   packed_vertex(c),        // stays
        packed_vertex(c + bit), packed_vertex(b),   packed_vertex(a + bit),  // the same, turned over
        packed_vertex(a),       packed_vertex(b),   packed_vertex(b + bit),  // to an edge
        packed_vertex(a),       packed_vertex(bit), packed_vertex(a),        // to a point
    };
    EXPECT_EQ(triangle_count(merged(packed_plant({corners}), 1.0f)), 1u);
}

TEST(VertexMerging, PartsStayApartAndKeepWhatTheyAre) {
    const std::vector<PackedVertex> near{packed_vertex({0, 0, 0}), packed_vertex({4, 0, 0}),
                                         packed_vertex({0, 4, 0})};
    std::vector<PackedVertex> shifted;
    for (const PackedVertex& v : near) shifted.push_back(packed_vertex(place_of(v) + vec3(0.2f, 0.2f, 0)));
    const Plant plant =
        merged(packed_plant({near, shifted}, k_part_leaf | k_part_closed | k_part_faces_outwards), 1.0f);
    ASSERT_EQ(plant.parts.size(), 2u);
    EXPECT_EQ(triangle_count(plant), 2u);
    EXPECT_EQ(plant.parts[1].flags, k_part_leaf | k_part_closed);  // merging may turn a triangle over
    EXPECT_TRUE(decode_surface(plant.triangle_vertices[0].surface).leaf);
    EXPECT_NE(place_of(plant.triangle_vertices[0]), place_of(plant.triangle_vertices[3]));
}

TEST(VertexMerging, EverythingInOneCellIsNothing) {
    const Plant nothing = merged(grid_plant(), 100.0f);
    EXPECT_EQ(nothing.parts.size(), 0u);
    EXPECT_EQ(nothing.bounds_plant.max, vec3(4, 0, 4));
}

TEST(VertexMerging, TrianglesWithoutAreaMakeNoNumberThatIsNone) {
    const std::vector<PackedVertex> line{packed_vertex({0, 0, 0}), packed_vertex({1, 0, 0}),
                                         packed_vertex({2, 0, 0})};
    const std::vector<PackedVertex> dot(3, packed_vertex({1, 1, 1}));
    for (float cell_m : {1e-9f, 0.1f, 1.0f, 10.0f}) {
        const Plant plant = merged(packed_plant({line, dot}), cell_m);
        for (const PackedVertex& v : plant.triangle_vertices) EXPECT_TRUE(is_finite(place_of(v)));
        EXPECT_EQ(area_m2(plant), 0.0);
    }
    EXPECT_EQ(make_vertex_merging_ladder(packed_plant({dot}))->size(), 1u);
}

TEST(VertexMerging, OneTriangleHasNothingCoarser) {
    const Plant one =
        packed_plant({{packed_vertex({0, 0, 0}), packed_vertex({1, 0, 0}), packed_vertex({0, 1, 0})}});
    auto ladder = make_vertex_merging_ladder(one);
    ASSERT_TRUE(ladder);
    ASSERT_EQ(ladder->size(), 1u);
    EXPECT_EQ(triangle_count(ladder->at(0).plant), 1u);
}

TEST(VertexMerging, ALadderDoublesItsCellsAndLosesTriangles) {
    PlantDescription tree;
    tree.name = "tree";
    tree.parts = {shapes::leaf_cloud(2000, 2.0f, 0.2f, 3), shapes::sphere(20, 30, 1.0f)};
    auto bytes = cook_plant(tree, {});
    ASSERT_TRUE(bytes);
    auto plant =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "tree");
    ASSERT_TRUE(plant);
    auto ladder = make_vertex_merging_ladder(*plant), again = make_vertex_merging_ladder(*plant);
    ASSERT_TRUE(ladder && again);
    ASSERT_GE(ladder->size(), 4u);
    EXPECT_EQ(ladder->at(0).grain_m, 0.0f);
    EXPECT_EQ(triangle_count(ladder->at(0).plant), triangle_count(*plant));
    for (size_t i = 1; i < ladder->size(); ++i) {
        const SubstituteLevel &finer = ladder->at(i - 1), &level = ladder->at(i);
        EXPECT_TRUE(i == 1 || level.grain_m == 2.0f * finer.grain_m);
        EXPECT_LT(triangle_count(level.plant), triangle_count(finer.plant));
        EXPECT_TRUE(std::isfinite(area_m2(level.plant)));
        EXPECT_TRUE(level.plant.points.empty() && level.plant.line_vertices.empty());
        EXPECT_EQ(level.plant.bounds_plant.min, plant->bounds_plant.min);
        EXPECT_EQ(level.plant.content_hash, again->at(i).plant.content_hash);
    }
    EXPECT_LE(ladder->back().grain_m, 0.5f * plant->bounds_plant.size().y);
    EXPECT_LT(triangle_count(ladder->back().plant), triangle_count(*plant) / 10);
}

}  // namespace
}  // namespace coppice
