#include "plugins/vegetation/cook/cut_part.h"

#include <gtest/gtest.h>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <tuple>
#include "plugins/vegetation/cook/cook_plant.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

constexpr uint32_t k_twigs = 500;

// A crown of 12000 leaves, and twigs of 8 rings in it.
PlantDescription large_tree() {
    PlantDescription tree;
    tree.name = "large";
    const vec3 center(0, 6, 0);
    tree.parts = {shapes::leaf_cloud(12000, 5.0f, 0.15f, 9, center)};
    PartDescription& bark = tree.parts.emplace_back();
    bark.name = "bark";
    Random random(12);
    for (uint32_t twig = 0; twig < k_twigs; ++twig) {
        const vec3 outwards = shapes::random_direction(random);
        const vec3 from = center + outwards * (5.0f * portable_pow(random.next_unit(), 1.0f / 3));
        const vec3 to = from + shapes::random_direction(random);
        shapes::add_tube(bark, shapes::straight_path(from, to, 9), std::vector<float>(9, 0.01f), 5);
    }
    return tree;
}

class CutPart : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        auto bytes = cook_plant(large_tree(), {});
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        auto plant = load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)),
                                            "large");
        ASSERT_TRUE(plant) << to_string(plant.error());
        plant_ = new Plant(std::move(*plant));
        ASSERT_EQ(plant_->parts.size(), 2u);
        ASSERT_EQ(plant_->parts[0].kind, PackedPartKind::points);
        ASSERT_EQ(plant_->parts[1].kind, PackedPartKind::lines);
        for (uint32_t p = 0; p < 2; ++p) ASSERT_GE(cells(p).size(), 8u);
    }
    static void TearDownTestSuite() {
        delete plant_;
        plant_ = nullptr;
    }

    static const Plant& plant() { return *plant_; }
    static std::vector<PackedPart> cells(uint32_t part) {
        std::vector<PackedPart> found;
        for (const PackedPart& cell : plant_->cells)
            if (cell.part == part) found.push_back(cell);
        return found;
    }
    static vec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

    static inline Plant* plant_ = nullptr;
};

TEST_F(CutPart, CellsShareTheirPartOut) {
    EXPECT_EQ(plant().triangle_vertices.size() / 3, 24000u + 80u * k_twigs);
    for (uint32_t p = 0; p < 2; ++p) {
        const PackedPart& part = plant().parts[p];
        uint32_t next_triangle = part.first_triangle, point_count = 0, line_count = 0;
        float area_m2 = 0.0f, length_m = 0.0f, seen_m2 = 0.0f;
        dvec3 color(0.0);
        for (const PackedPart& cell : cells(p)) {
            EXPECT_STREQ(cell.name, part.name);
            EXPECT_EQ(cell.kind, part.kind);
            EXPECT_EQ(cell.flags, part.flags);
            EXPECT_EQ(cell.importance, part.importance);
            EXPECT_EQ(cell.line_error_m, part.line_error_m);
            EXPECT_EQ(cell.first_triangle, next_triangle);
            EXPECT_GT(cell.point_count + cell.line_count, 0u);
            EXPECT_LE(cell.longest_edge_m, part.longest_edge_m);
            next_triangle += cell.triangle_count;
            point_count += cell.point_count;
            line_count += cell.line_count;
            area_m2 += cell.area_m2;
            length_m += cell.line_length_m;
            seen_m2 += cell.projected_area_m2.evaluate(vec3(0, 0, 1));
            for (int c = 0; c < 3; ++c) color[c] += double(cell.mean_color_linear[c] * cell.area_m2);
        }
        EXPECT_EQ(next_triangle, part.first_triangle + part.triangle_count);
        EXPECT_NEAR(area_m2, part.area_m2, 1e-4f * area_m2);
        EXPECT_NEAR(length_m, part.line_length_m, 1e-4f * length_m);
        EXPECT_NEAR(seen_m2, part.projected_area_m2.evaluate(vec3(0, 0, 1)), 0.02f * seen_m2);
        EXPECT_EQ(part.line_count, line_count);
        EXPECT_EQ(part.point_count, point_count / 4);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(color[c] / double(part.area_m2), double(part.mean_color_linear[c]),
                        0.02 * double(part.mean_color_linear[c]));
    }
}

TEST_F(CutPart, NoTriangleIsLost) {
    const PlantDescription tree = large_tree();
    using Corners = std::multiset<std::tuple<float, float, float>>;
    std::multiset<Corners> wanted, found;
    for (const PartDescription& part : tree.parts)
        for (size_t i = 0; i < part.indices.size(); i += 3) {
            Corners corners;
            for (size_t k = 0; k < 3; ++k) {
                const vec3 p = part.vertices[part.indices[i + k]].position_plant;
                corners.insert({p.x, p.y, p.z});
            }
            wanted.insert(corners);
        }
    for (size_t i = 0; i < plant().triangle_vertices.size(); i += 3) {
        Corners corners;
        for (size_t k = 0; k < 3; ++k) {
            const vec3 p = position_of(plant().triangle_vertices[i + k]);
            corners.insert({p.x, p.y, p.z});
        }
        found.insert(corners);
    }
    EXPECT_TRUE(wanted == found);
}

TEST_F(CutPart, CellsLieWithinTheirBounds) {
    for (const PackedPart& cell : plant().cells) {
        auto expect_inside = [&cell](const PackedVertex& v) {
            const float at[3] = {v.x_plant, v.y_plant, v.z_plant};
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_GE(at[axis], cell.bounds_min[axis] - 1e-5f);
                ASSERT_LE(at[axis], cell.bounds_max[axis] + 1e-5f);
            }
        };
        for (const PackedVertex& v :
             plant().triangle_vertices.subspan(3 * cell.first_triangle, 3 * cell.triangle_count))
            expect_inside(v);
        for (const PackedVertex& v : plant().points.subspan(cell.first_point, cell.point_count))
            expect_inside(v);
        for (const PackedVertex& v : plant().line_vertices.subspan(2 * cell.first_line, 2 * cell.line_count))
            expect_inside(v);
        EXPECT_LT(cell.bounds_max[0] - cell.bounds_min[0], 7.0f) << "of a crown of 10 m and twigs of 1 m";
    }
}

// Points lie on their triangles, and triangles of a stem around a line of their own cell.
TEST_F(CutPart, PointsAndLinesStandWithTheirTriangles) {
    for (const PackedPart& cell : plant().cells) {
        for (uint32_t i = cell.first_point; i < cell.first_point + cell.point_count; ++i) {
            const PackedVertex* v =
                &plant().triangle_vertices[3 * size_t(cell.first_triangle + plant().point_owners[i])];
            const vec3 a = position_of(v[0]), n = glm::cross(position_of(v[1]) - a, position_of(v[2]) - a);
            const vec3 away = position_of(plant().points[i]) - a;
            ASSERT_LT(std::fabs(glm::dot(away, normalize_or(n, vec3(0)))), 1e-5f);
            ASSERT_LT(glm::length(away), 0.22f) << "a leaf's diagonal";
        }
        if (cell.kind != PackedPartKind::lines) continue;
        for (uint32_t t = cell.first_triangle; t < cell.first_triangle + cell.triangle_count; ++t) {
            const vec3 p = position_of(plant().triangle_vertices[3 * size_t(t)]);
            float nearest = INFINITY;
            for (uint32_t l = cell.first_line; l < cell.first_line + cell.line_count; ++l) {
                const vec3 a = position_of(plant().line_vertices[2 * size_t(l)]),
                           b = position_of(plant().line_vertices[2 * size_t(l) + 1]);
                const float along = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0f, 1.0f);
                nearest = std::min(nearest, glm::length(p - a - (b - a) * along));
            }
            ASSERT_LT(nearest, 0.011f);
        }
    }
}

// So handing over cannot pop: what a part draws of a cell is what the cell would draw.
TEST_F(CutPart, PrefixesOfAPartArePrefixesOfItsCells) {
    auto key_of = [](const PackedVertex& v) {
        return std::tuple(v.x_plant, v.y_plant, v.z_plant, v.surface);
    };
    for (uint32_t p = 0; p < 2; ++p) {
        const PackedPart& part = plant().parts[p];
        const bool lines = part.kind == PackedPartKind::lines;
        std::map<std::tuple<float, float, float, uint32_t>, std::pair<size_t, uint32_t>> place_of;
        const std::vector<PackedPart> of_part = cells(p);
        for (size_t c = 0; c < of_part.size(); ++c)
            for (uint32_t i = 0; i < (lines ? of_part[c].line_count : of_part[c].point_count); ++i)
                place_of[key_of(lines ? plant().line_vertices[2 * size_t(of_part[c].first_line + i)]
                                      : plant().points[of_part[c].first_point + i])] = {c, i};
        std::vector<uint32_t> taken(of_part.size(), 0);
        for (uint32_t i = 0; i < (lines ? part.line_count : part.point_count); ++i) {
            const auto found =
                place_of.find(key_of(lines ? plant().line_vertices[2 * size_t(part.first_line + i)]
                                           : plant().points[part.first_point + i]));
            ASSERT_TRUE(found != place_of.end()) << i;
            const auto [c, index] = found->second;
            ASSERT_EQ(index, taken[c]++) << "the cell's next one";
            if (lines) continue;
            ASSERT_EQ(part.first_triangle + plant().point_owners[part.first_point + i],
                      of_part[c].first_triangle + plant().point_owners[of_part[c].first_point + index]);
        }
        for (size_t c = 0; c < of_part.size() && !lines; ++c)
            EXPECT_NEAR(float(taken[c]) / float(part.point_count), of_part[c].area_m2 / part.area_m2, 0.01f);
    }
}

TEST_F(CutPart, GainsBelongToPointsAndWidthsToCells) {
    const PackedPart& leaves = plant().parts[0];
    uint32_t point_count = 0;
    for (const PackedPart& cell : cells(0)) {
        point_count += cell.point_count;
        EXPECT_EQ(cell.coverage_gain, cells(0)[0].coverage_gain);
    }
    for (float fill : {0.003f, 0.05f, 0.24f})
        EXPECT_NEAR(gain_at(leaves, fill * float(point_count) / float(leaves.point_count)),
                    gain_at(cells(0)[0], fill), 0.01f)
            << fill;
    for (const PackedPart& cell : cells(1)) {
        double width = 0.0, length_m = 0.0;
        for (uint32_t i = cell.first_line; i < cell.first_line + cell.line_count; ++i) {
            const PackedVertex* v = &plant().line_vertices[2 * size_t(i)];
            const double l = double(glm::length(position_of(v[1]) - position_of(v[0])));
            length_m += l;
            width += l * double(std::bit_cast<float>(v[1].surface));
        }
        EXPECT_NEAR(length_m, double(cell.line_length_m), 1e-3 * length_m);
        EXPECT_NEAR(width / length_m, 1.0, 0.05) << "over the cell's mean";
    }
}

// Made with gcc 12; clang and any number of threads must give it too.
TEST_F(CutPart, EveryCompilerAndThreadCountGivesTheSameBytes) {
    const PlantDescription tree = large_tree();
    for (unsigned threads : {1u, 2u}) {
        set_thread_limit(threads);
        auto bytes = cook_plant(tree, {});
        set_thread_limit(0);
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        EXPECT_EQ(hash_to_hex(hash_bytes(bytes->data(), bytes->size())), "59db1ce7865820ee")
            << threads
            << " threads\nIf the cook was changed on purpose: raise k_cook_version (cook_plant.h).";
    }
}

}  // namespace
}  // namespace coppice
