#include "plugins/vegetation/cook/build_octree.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <tuple>
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/cook/trace_lines.h"
#include "plugins/vegetation/cook/triangle_areas.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

CookPart points_part(PartDescription mesh) {
    mesh.kind = PartKind::points;
    CookPart part{{std::move(mesh), {}}, false};
    std::tie(part.area_m2, part.mean_color_linear) = measure_area_and_color(part.shape.part);
    return part;
}

// Twigs of 8 segments, 10 triangles each, anywhere in a ball.
CookPart twigs_part(uint32_t twig_count, float radius_m) {
    CookPart part;
    part.closed = true;
    PartDescription& mesh = part.shape.part;
    mesh.name = "bark";
    mesh.kind = PartKind::lines;
    Random random(12);
    for (uint32_t twig = 0; twig < twig_count; ++twig) {
        vec3 outwards = shapes::random_direction(random);
        vec3 from = outwards * (radius_m * portable_pow(random.next_unit(), 1.0f / 3));
        vec3 to = from + shapes::random_direction(random);
        std::vector<vec3> path = shapes::straight_path(from, to, 9);
        shapes::add_tube(mesh, path, std::vector<float>(9, 0.01f), 5);
        for (uint32_t s = 0; s < 8; ++s)
            part.shape.skeleton.segments.push_back({path[s], path[s + 1], 0.01f, 0.01f, twig, 1, vec3(0.1f)});
    }
    for (uint32_t t = 0; t < mesh.indices.size() / 3; ++t)
        part.shape.skeleton.triangle_segment.push_back(t / 10);
    std::tie(part.area_m2, part.mean_color_linear) = measure_area_and_color(mesh);
    return part;
}

uint32_t triangle_count(const CookPart& part) { return uint32_t(part.shape.part.indices.size() / 3); }

std::array<vec3, 3> corners(const CookPart& part, uint32_t triangle) {
    const PartDescription& mesh = part.shape.part;
    return {mesh.vertices[mesh.indices[3 * triangle]].position_plant,
            mesh.vertices[mesh.indices[3 * triangle + 1]].position_plant,
            mesh.vertices[mesh.indices[3 * triangle + 2]].position_plant};
}

using Triangle = std::array<float, 9>;
std::multiset<Triangle> triangles_of(std::span<const CookPart> parts) {
    std::multiset<Triangle> triangles;
    for (const CookPart& part : parts)
        for (uint32_t t = 0; t < triangle_count(part); ++t) {
            auto [a, b, c] = corners(part, t);
            triangles.insert({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z});
        }
    return triangles;
}

Box box_of(const CookPart& part) {
    Box box;
    for (const DescriptionVertex& v : part.shape.part.vertices) box.include(v.position_plant);
    return box;
}

TEST(BuildOctree, SharesACrownOutAndLosesNothing) {
    const CookPart crown = points_part(shapes::leaf_cloud(20000, 6.0f, 0.1f, 3));
    const std::vector<std::vector<CookPart>> cells = build_octree({crown});
    ASSERT_EQ(cells.size(), 1u);
    ASSERT_EQ(cells[0].size(), 8u) << "40000 triangles: eight cells of 5000, which are not worth 64";
    EXPECT_EQ(triangles_of(cells[0]), triangles_of({&crown, 1}));
    double area_m2 = 0.0;
    dvec3 color(0.0);
    for (const CookPart& cell : cells[0]) {
        EXPECT_EQ(cell.shape.part.name, "leaf");
        EXPECT_TRUE(cell.shape.part.leaf);
        EXPECT_EQ(cell.shape.part.kind, PartKind::points);
        area_m2 += cell.area_m2;
        color += dvec3(cell.mean_color_linear) * cell.area_m2;
        const vec3 size = box_of(cell).size();
        EXPECT_LT(std::max({size.x, size.y, size.z}), 6.5f) << "half the crown, and half a leaf";
        for (uint32_t index : cell.shape.part.indices) ASSERT_LT(index, cell.shape.part.vertices.size());
        std::vector<bool> used(cell.shape.part.vertices.size(), false);
        for (uint32_t index : cell.shape.part.indices) used[index] = true;
        EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
    }
    EXPECT_NEAR(area_m2, crown.area_m2, 1e-9 * crown.area_m2);
    EXPECT_NEAR(color.y / area_m2, double(crown.mean_color_linear.y), 1e-6);
}

TEST(BuildOctree, CutsDenseCellsTwice) {
    const std::vector<CookPart> cells =
        build_octree({points_part(shapes::leaf_cloud(80000, 8.0f, 0.1f, 5))})[0];
    EXPECT_GT(cells.size(), 16u);
    EXPECT_LE(cells.size(), size_t(k_part_limit));
    uint64_t total = 0;
    for (const CookPart& cell : cells) {
        total += triangle_count(cell);
        EXPECT_GE(triangle_count(cell), k_cell_least_triangles / 4);
        EXPECT_LT(glm::length(box_of(cell).size()), 2.0f * 8.0f);
    }
    EXPECT_EQ(total, 160000u);
}

TEST(BuildOctree, LeavesSmallAndSparsePlantsWhole) {
    for (float radius_m : {1.0f, 1.7f}) {  // 3 m about the box's diagonal
        const auto cells = build_octree({points_part(shapes::leaf_cloud(20000, radius_m, 0.05f, 3))});
        EXPECT_EQ(cells[0].size(), 1u) << radius_m;
    }
    EXPECT_EQ(build_octree({points_part(shapes::leaf_cloud(5000, 6.0f, 0.1f, 3))})[0].size(), 1u)
        << "1250 triangles a cell";
    EXPECT_TRUE(build_octree({}).empty());
    // A cell as small as 2 m is not cut, however dense.
    const auto dense = build_octree({points_part(shapes::leaf_cloud(60000, 3.0f, 0.05f, 3))});
    for (const CookPart& cell : dense[0]) EXPECT_GT(glm::length(box_of(cell).size()), 2.0f);
}

TEST(BuildOctree, SmallPartsOfALargePlantStayWhole) {
    std::vector<CookPart> parts{points_part(shapes::leaf_cloud(20000, 6.0f, 0.1f, 3)),
                                points_part(shapes::leaf_cloud(100, 6.0f, 0.1f, 4))};
    const auto cells = build_octree(parts);
    EXPECT_EQ(cells[0].size(), 8u);
    ASSERT_EQ(cells[1].size(), 1u);
    EXPECT_EQ(triangle_count(cells[1][0]), 200u);
}

TEST(BuildOctree, NeverMakesMorePartsThanTheLimit) {
    std::vector<CookPart> parts;
    for (uint64_t i = 0; i < 6; ++i)
        parts.push_back(points_part(shapes::leaf_cloud(10000 + 1000 * uint32_t(i), 6.0f, 0.1f, i + 1)));
    for (uint32_t limit : {6u, 12u, 13u, 20u, 64u}) {
        const auto cells = build_octree(parts, limit);
        size_t count = 0, triangles = 0;
        for (const auto& of_part : cells) {
            count += of_part.size();
            for (const CookPart& cell : of_part) triangles += triangle_count(cell);
        }
        EXPECT_LE(count, limit);
        EXPECT_EQ(triangles, 2u * 75000u);
        EXPECT_EQ(cells[5].size(), limit >= 13 ? 8u : 1u) << "the largest comes first";
        EXPECT_EQ(cells[0].size(), limit >= 48 ? 8u : 1u);
    }
}

TEST(BuildOctree, CutsFlatPlantsIntoSquares) {
    PartDescription carpet;
    Random random(1);
    for (int i = 0; i < 20000; ++i)
        shapes::add_quad(carpet, vec3(random.next_in(-5, 5), 0, random.next_in(-5, 5)), vec3(0, 0, 0.05f),
                         vec3(0.05f, 0, 0));
    const std::vector<CookPart> cells = build_octree({points_part(carpet)})[0];
    EXPECT_EQ(cells.size(), 16u);
    uint64_t total = 0;
    for (const CookPart& cell : cells) total += triangle_count(cell);
    EXPECT_EQ(total, 40000u);
}

TEST(BuildOctree, LeavesAPileWhole) {
    PartDescription pile;
    for (int i = 0; i < 20000; ++i) shapes::add_quad(pile, vec3(4, 7, 4), vec3(0, 0, 0.5f), vec3(0.5f, 0, 0));
    std::vector<CookPart> parts{points_part(pile)};
    PartDescription outlier;
    shapes::add_quad(outlier, vec3(-9, 0, -9), vec3(0, 0, 1), vec3(1, 0, 0));
    parts.push_back(points_part(outlier));  // makes the plant large
    const auto cells = build_octree(parts);
    ASSERT_EQ(cells[0].size(), 1u);
    EXPECT_EQ(triangle_count(cells[0][0]), 40000u);
}

TEST(BuildOctree, StemsGoBySegmentsAndStayConsistent) {
    const CookPart whole = twigs_part(800, 5.0f);
    const std::vector<CookPart> cells = build_octree({whole})[0];
    ASSERT_GE(cells.size(), 8u);
    EXPECT_EQ(triangles_of(cells), triangles_of({&whole, 1}));
    size_t segments = 0;
    float length_m = 0.0f;
    for (const CookPart& cell : cells) {
        const TracedSkeleton& skeleton = cell.shape.skeleton;
        EXPECT_TRUE(cell.closed);
        segments += skeleton.segments.size();
        ASSERT_EQ(skeleton.triangle_segment.size(), triangle_count(cell));
        for (uint32_t t = 0; t < triangle_count(cell); ++t) {
            const SkeletonSegment& segment = skeleton.segments[skeleton.triangle_segment[t]];
            for (vec3 p : corners(cell, t))
                ASSERT_LT(distance_to_segment(p, segment.begin_plant, segment.end_plant), 0.011f);
        }
        const TracedLines traced = trace_lines(cell.shape.part, skeleton);
        EXPECT_LT(traced.error_m, 0.011f);
        length_m += traced.length_m;
    }
    EXPECT_EQ(segments, whole.shape.skeleton.segments.size());
    EXPECT_NEAR(length_m, 800.0f, 1.0f);
}

TEST(BuildOctree, LeavesKnownApartStayInOnePiece) {
    PartDescription mesh = shapes::leaf_cloud(20000, 6.0f, 1.0f, 3);
    for (uint32_t t = 0; t <= 40000; t += 2) mesh.element_first_triangle.push_back(t);
    const CookPart crown = points_part(mesh);
    size_t leaves = 0;
    const auto cells = build_octree({crown});
    for (const CookPart& cell : cells[0]) {
        const auto& elements = cell.shape.part.element_first_triangle;
        ASSERT_GE(elements.size(), 2u);
        EXPECT_EQ(elements.front(), 0u);
        EXPECT_EQ(elements.back(), triangle_count(cell));
        for (size_t e = 0; e + 1 < elements.size(); ++e) {
            ASSERT_EQ(elements[e + 1] - elements[e], 2u);
            ASSERT_EQ(corners(cell, elements[e])[0], corners(cell, elements[e] + 1)[0]) << "one quad";
        }
        leaves += elements.size() - 1;
    }
    EXPECT_EQ(leaves, 20000u);
}

PlantDescription large_tree() {
    PlantDescription tree;
    tree.name = "large";
    tree.parts = {shapes::leaf_cloud(12000, 5.0f, 0.15f, 9, vec3(0, 6, 0)), twigs_part(500, 5.0f).shape.part};
    tree.parts[1].kind = PartKind::automatic;
    for (DescriptionVertex& v : tree.parts[1].vertices) v.position_plant.y += 6.0f;
    return tree;
}

Plant cook_large_tree() {
    auto bytes = cook_plant(large_tree(), {});
    EXPECT_TRUE(bytes) << to_string(bytes.error());
    auto plant =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "large");
    EXPECT_TRUE(plant) << to_string(plant.error());
    return std::move(*plant);
}

TEST(BuildOctree, CookedCellsShareTheirPartOut) {
    const Plant plant = cook_large_tree();
    ASSERT_EQ(plant.parts.size(), 2u);
    EXPECT_EQ(plant.triangle_vertices.size() / 3, 24000u + 40000u);
    for (uint32_t p = 0; p < 2; ++p) {
        const PackedPart& part = plant.parts[p];
        std::vector<PackedPart> cells;
        for (const PackedPart& cell : plant.cells)
            if (cell.part == p) cells.push_back(cell);
        ASSERT_GE(cells.size(), 8u);
        uint32_t next_triangle = part.first_triangle, point_count = 0, line_count = 0;
        float area_m2 = 0.0f, length_m = 0.0f, seen_m2 = 0.0f;
        for (const PackedPart& cell : cells) {
            EXPECT_STREQ(cell.name, part.name);
            EXPECT_EQ(cell.kind, part.kind);
            EXPECT_EQ(cell.flags, part.flags);
            EXPECT_EQ(cell.importance, part.importance);
            EXPECT_EQ(cell.coverage_gain, cells[0].coverage_gain);
            EXPECT_EQ(cell.first_triangle, next_triangle);
            EXPECT_GT(cell.point_count + cell.line_count, 0u);
            next_triangle += cell.triangle_count;
            point_count += cell.point_count;
            line_count += cell.line_count;
            area_m2 += cell.area_m2;
            length_m += cell.line_length_m;
            seen_m2 += cell.projected_area_m2.evaluate(vec3(0, 0, 1));
            for (uint32_t v = 3 * cell.first_triangle; v < 3 * next_triangle; ++v) {
                const PackedVertex& vertex = plant.triangle_vertices[v];
                const float at[3] = {vertex.x_plant, vertex.y_plant, vertex.z_plant};
                for (int axis = 0; axis < 3; ++axis) {
                    ASSERT_GE(at[axis], cell.bounds_min[axis]);
                    ASSERT_LE(at[axis], cell.bounds_max[axis]);
                }
            }
        }
        EXPECT_EQ(next_triangle, part.first_triangle + part.triangle_count);
        EXPECT_NEAR(area_m2, part.area_m2, 1e-4f * area_m2);
        EXPECT_NEAR(length_m, part.line_length_m, 1e-4f * length_m);
        EXPECT_NEAR(seen_m2, part.projected_area_m2.evaluate(vec3(0, 0, 1)), 0.02f * seen_m2);
        EXPECT_EQ(part.line_count, line_count);
        EXPECT_LE(part.point_count, point_count / 4);
        EXPECT_GE(part.point_count, point_count / 5);
    }
    EXPECT_EQ(plant.parts[0].kind, PackedPartKind::points);
    EXPECT_EQ(plant.parts[1].kind, PackedPartKind::lines);
}

// What is drawn in one piece far away is what the cells draw nearer by: a prefix of the part's points or lines is a prefix
// of each cell's, as long as its area or number asks for.
TEST(BuildOctree, PrefixesOfAPartArePrefixesOfItsCells) {
    const Plant plant = cook_large_tree();
    auto key_of = [](const PackedVertex& v) {
        return std::tuple(v.x_plant, v.y_plant, v.z_plant, v.surface);
    };
    for (uint32_t p = 0; p < 2; ++p) {
        const PackedPart& part = plant.parts[p];
        const bool lines = part.kind == PackedPartKind::lines;
        std::map<std::tuple<float, float, float, uint32_t>, std::pair<uint32_t, uint32_t>> place_of;
        for (uint32_t c = 0; c < plant.cells.size(); ++c) {
            const PackedPart& cell = plant.cells[c];
            if (cell.part != p) continue;
            for (uint32_t i = 0; i < (lines ? cell.line_count : cell.point_count); ++i)
                place_of[key_of(lines ? plant.line_vertices[2 * (cell.first_line + i)]
                                      : plant.points[cell.first_point + i])] = {c, i};
        }
        std::vector<uint32_t> taken(plant.cells.size(), 0);
        const uint32_t count = lines ? part.line_count : part.point_count;
        for (uint32_t i = 0; i < count; ++i) {
            const PackedVertex& vertex =
                lines ? plant.line_vertices[2 * (part.first_line + i)] : plant.points[part.first_point + i];
            const auto found = place_of.find(key_of(vertex));
            ASSERT_TRUE(found != place_of.end()) << i;
            const auto [c, index] = found->second;
            ASSERT_EQ(index, taken[c]++) << "the cell's next one";
            const PackedPart& cell = plant.cells[c];
            const float share = lines ? float(cell.line_count) / float(count) : cell.area_m2 / part.area_m2;
            ASSERT_NEAR(float(taken[c]), share * float(i + 1), 1.5f);
            if (lines) continue;
            // Its triangle is the same one.
            ASSERT_EQ(part.first_triangle + plant.point_owners[part.first_point + i],
                      cell.first_triangle + plant.point_owners[cell.first_point + index]);
        }
    }
}

TEST(BuildOctree, AJoinedPartHasTheGainOfItsCellsAndTheirWidths) {
    const Plant plant = cook_large_tree();
    const PackedPart &leaves = plant.parts[0], &bark = plant.parts[1];
    uint32_t point_count = 0;
    double width = 0.0, length_m = 0.0;
    for (const PackedPart& cell : plant.cells)
        if (cell.part == 0) point_count += cell.point_count;
    for (float fill : {0.003f, 0.05f, 0.24f})
        EXPECT_NEAR(gain_at(leaves, fill * float(point_count) / float(leaves.point_count)),
                    gain_at(plant.cells[0], fill), 0.01f)
            << fill;
    for (uint32_t i = bark.first_line; i < bark.first_line + bark.line_count; ++i) {
        const PackedVertex* v = &plant.line_vertices[2 * i];
        const double l = double(glm::length(
            vec3(v[1].x_plant - v[0].x_plant, v[1].y_plant - v[0].y_plant, v[1].z_plant - v[0].z_plant)));
        length_m += l;
        width += l * double(std::bit_cast<float>(v[1].surface));
    }
    EXPECT_NEAR(length_m, double(bark.line_length_m), 1e-3 * length_m);
    EXPECT_NEAR(width / length_m, 1.0, 0.02) << "widths over the part's mean";
}

// Made with gcc 12; clang and any number of threads must give it too.
TEST(BuildOctree, EveryCompilerAndThreadCountGivesTheSameBytes) {
    const PlantDescription tree = large_tree();
    for (unsigned threads : {1u, 2u}) {
        set_thread_limit(threads);
        auto bytes = cook_plant(tree, {});
        set_thread_limit(0);
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        EXPECT_EQ(hash_to_hex(hash_bytes(bytes->data(), bytes->size())), "c626897397a95ee2")
            << threads
            << " threads\nIf the cook was changed on purpose: raise k_cook_version (cook_plant.h).";
    }
}

}  // namespace
}  // namespace coppice
