#include "plugins/vegetation/cook/cook_plant.h"

#include <gtest/gtest.h>
#include <bit>
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

Plant cook(const PlantDescription& description, const CookSettings& settings = {}) {
    auto bytes = cook_plant(description, settings);
    if (!bytes) {
        ADD_FAILURE() << to_string(bytes.error());
        return {};
    }
    auto plant =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "cooked");
    if (!plant) {
        ADD_FAILURE() << to_string(plant.error());
        return {};
    }
    return std::move(*plant);
}

PlantDescription small_tree() {
    PlantDescription tree;
    tree.name = "tree";
    PartDescription bark;
    bark.name = "bark";
    shapes::add_tube(bark, shapes::straight_path(vec3(0), vec3(0, 4, 0), 20), std::vector<float>(20, 0.1f));
    Random random(4);
    for (int i = 0; i < 40; ++i) {
        vec3 from(0, random.next_in(2, 4), 0);
        shapes::add_tube(bark, shapes::straight_path(from, from + shapes::random_direction(random) * 1.5f, 8),
                         std::vector<float>(8, 0.012f), 5);
    }
    tree.parts.push_back(bark);
    tree.parts.push_back(shapes::leaf_cloud(3000, 2.0f, 0.05f, 9, vec3(0, 4, 0)));
    return tree;
}

vec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

float distance_to_triangle_plane(vec3 p, vec3 a, vec3 b, vec3 c) {
    return std::fabs(glm::dot(p - a, normalize_or(glm::cross(b - a, c - a), vec3(0))));
}

TEST(CookPlant, SplitsATreeIntoPointsAndLinesByThickness) {
    Plant plant = cook(small_tree());
    ASSERT_EQ(plant.parts.size(), 3u);
    EXPECT_STREQ(plant.parts[0].name, "bark");
    EXPECT_STREQ(plant.parts[1].name, "bark/4");
    EXPECT_STREQ(plant.parts[2].name, "leaf");
    EXPECT_EQ(plant.parts[0].kind, PackedPartKind::lines);
    EXPECT_EQ(plant.parts[1].kind, PackedPartKind::lines);
    EXPECT_EQ(plant.parts[2].kind, PackedPartKind::points);
    EXPECT_NEAR(plant.parts[0].line_error_m, 0.1f, 0.005f);
    EXPECT_NEAR(plant.parts[1].line_error_m, 0.012f, 0.001f);
    EXPECT_NEAR(plant.parts[0].line_length_m, 4.0f, 0.05f);
    EXPECT_NEAR(plant.parts[1].line_length_m, 60.0f, 0.5f);
    EXPECT_EQ(plant.parts[0].flags, k_part_closed | k_part_faces_outwards) << "a tube is closed";
    EXPECT_EQ(plant.parts[2].flags, k_part_leaf) << "a leaf is not";
    EXPECT_EQ(plant.parts[2].point_count, 2 * plant.parts[2].triangle_count);
    EXPECT_NEAR(plant.parts[2].area_m2, 3000 * 0.05f * 0.05f, 1e-3f);
}

// What a person says of a part goes before what its shape and colour do.
TEST(CookPlant, PartsAreWhatAPersonSetThemTo) {
    PlantDescription tree = small_tree();
    const Plant automatic = cook(tree);
    tree.settings = {{"bark/4", PartKind::points, 2.5f}, {"leaf", PartKind::points, 0.0f}};
    Plant plant = cook(tree);
    ASSERT_EQ(plant.parts.size(), 3u);
    EXPECT_EQ(plant.parts[0].kind, PackedPartKind::lines);
    EXPECT_EQ(plant.parts[1].kind, PackedPartKind::points);
    EXPECT_EQ(plant.parts[1].line_count, 0u);
    EXPECT_GE(plant.parts[1].point_count, 2 * plant.parts[1].triangle_count);
    EXPECT_FLOAT_EQ(plant.parts[1].importance, 2.5f);
    EXPECT_FLOAT_EQ(plant.parts[0].importance, automatic.parts[0].importance);
    EXPECT_FALSE(automatic.crowns.empty());
    EXPECT_TRUE(plant.crowns.empty()) << "points and nothing else";

    tree.settings = {{"leaf", PartKind::leaves, 0.0f}};
    plant = cook(tree);
    ASSERT_EQ(plant.crowns.size(), 1u);
    EXPECT_EQ(plant.parts[2].flags, k_part_leaf | k_part_prefers_leaves);
    tree.settings = {{"leaf", PartKind::lines, 0.0f}};
    plant = cook(tree);
    EXPECT_EQ(plant.parts[2].kind, PackedPartKind::lines);
    EXPECT_GT(plant.parts[2].line_count, 1000u);

    tree.settings = {{"bark", PartKind::leaves, 0.0f}};
    auto refused = cook_plant(tree, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().id, ErrorId::value_out_of_range);
    // A name that no part has, as after another export, is no reason to have no plant.
    tree.settings = {{"barque", PartKind::points, 3.0f}};
    plant = cook(tree);
    EXPECT_EQ(plant.content_hash, automatic.content_hash);
}

TEST(CookPlant, EveryPointLiesOnItsOwner) {
    Plant plant = cook(small_tree());
    for (const PackedPart& part : plant.parts) {
        for (uint32_t i = 0; i < part.point_count; ++i) {
            uint32_t triangle = part.first_triangle + plant.point_owners[part.first_point + i];
            vec3 p = position_of(plant.points[part.first_point + i]);
            vec3 a = position_of(plant.triangle_vertices[3 * triangle]);
            vec3 b = position_of(plant.triangle_vertices[3 * triangle + 1]);
            vec3 c = position_of(plant.triangle_vertices[3 * triangle + 2]);
            ASSERT_LT(distance_to_triangle_plane(p, a, b, c), 1e-5f);
            // Inside: the three partial areas sum up to the whole.
            auto area = [](vec3 x, vec3 y, vec3 z) {
                vec3 n = glm::cross(y - x, z - x);
                return std::sqrt(glm::dot(n, n));
            };
            ASSERT_NEAR(area(p, b, c) + area(a, p, c) + area(a, b, p), area(a, b, c),
                        1e-3f * area(a, b, c) + 1e-7f);
        }
    }
}

TEST(CookPlant, KeepsTheMeanColorInEveryRepresentation) {
    PlantDescription description = small_tree();
    Random random(77);
    for (int i = 0; i < 600; ++i) {
        vec3 from(0, random.next_in(2, 4), 0);
        vec3 to = from + shapes::random_direction(random) * 1.5f;
        shapes::add_tube(description.parts[0], shapes::straight_path(from, to, 4),
                         std::vector<float>(4, 0.012f), 5);
    }
    for (PartDescription& part : description.parts)
        for (DescriptionVertex& v : part.vertices)
            v.color_linear =
                vec3(random.next_in(0.05f, 0.2f), random.next_in(0.2f, 0.5f), random.next_in(0, 0.1f));
    Plant plant = cook(description);
    for (const PackedPart& part : plant.parts) {
        dvec3 expected(part.mean_color_linear[0], part.mean_color_linear[1], part.mean_color_linear[2]);
        auto expect_mean = [&](dvec3 sum, double weight, const char* what) {
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(sum[c] / weight / expected[c], 1.0, 0.03) << part.name << " " << what;
        };
        dvec3 triangles(0), points(0), lines(0);
        double area = 0, length = 0;
        for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
            const PackedVertex* v = &plant.triangle_vertices[3 * t];
            vec3 n = glm::cross(position_of(v[1]) - position_of(v[0]), position_of(v[2]) - position_of(v[0]));
            double a = double(std::sqrt(glm::dot(n, n)));
            area += a;
            for (int k = 0; k < 3; ++k)
                triangles += dvec3(decode_surface(v[k].surface).color_linear) * (a / 3);
        }
        expect_mean(triangles, area, "triangles");
        for (uint32_t i = 0; i < part.point_count; ++i)
            points += dvec3(decode_surface(plant.points[part.first_point + i].surface).color_linear);
        if (part.point_count) expect_mean(points, part.point_count, "points");
        for (uint32_t i = part.first_line; i < part.first_line + part.line_count; ++i) {
            const PackedVertex* v = &plant.line_vertices[2 * i];
            vec3 along = position_of(v[1]) - position_of(v[0]);
            double l = double(std::sqrt(glm::dot(along, along)));
            l *= double(std::bit_cast<float>(v[1].surface));  // its width over the mean
            length += l;
            lines += dvec3(decode_surface(v[0].surface).color_linear) * l;
        }
        // Few lines: the dither's noise is larger than what is asked of the mean.
        if (part.line_count > 300) expect_mean(lines, length, "lines");
    }
}

TEST(CookPlant, SameBytesOnOneAndTwoThreads) {
    PlantDescription tree = small_tree();
    set_thread_limit(1);
    auto one = cook_plant(tree, {});
    set_thread_limit(2);
    auto two = cook_plant(tree, {});
    set_thread_limit(0);
    ASSERT_TRUE(one && two);
    EXPECT_TRUE(*one == *two);
}

// Made with gcc 12; clang and any number of threads must give it too.
TEST(CookPlant, EveryCompilerGivesTheSameBytes) {
    PlantDescription tree = small_tree();
    for (unsigned threads : {1u, 2u}) {
        set_thread_limit(threads);
        auto bytes = cook_plant(tree, {});
        set_thread_limit(0);
        ASSERT_TRUE(bytes);
        EXPECT_EQ(hash_to_hex(hash_bytes(bytes->data(), bytes->size())), "b8252f2c63cdaa9c")
            << threads
            << " threads\nIf the cook was changed on purpose: raise k_cook_version (cook_plant.h), else "
            << "plants of the old form stay in the caches, and write the new hash here.";
    }
}

TEST(CookPlant, TakesOneTriangle) {
    PlantDescription plant;
    plant.name = "one";
    plant.parts.emplace_back();
    shapes::add_triangle(plant.parts[0], vec3(0), vec3(1, 0, 0), vec3(0, 0, 1));
    Plant packed = cook(plant);
    ASSERT_EQ(packed.parts.size(), 1u);
    EXPECT_EQ(packed.parts[0].triangle_count, 1u);
    EXPECT_EQ(packed.parts[0].point_count, 2u);
    EXPECT_EQ(packed.point_owners[1], 0u);
}

TEST(CookPlant, TakesPlantsWithoutDepthAndPilesOfEqualTriangles) {
    PlantDescription plant;
    plant.name = "flat";
    plant.parts.resize(2);
    for (int i = 0; i < 100; ++i) {
        shapes::add_quad(plant.parts[0], vec3(float(i % 10), 0, float(i / 10)), vec3(0, 0, 0.9f),
                         vec3(0.9f, 0, 0));
        shapes::add_quad(plant.parts[1], vec3(5, 0, 5), vec3(0, 0, 0.9f), vec3(0.9f, 0, 0));
    }
    Plant packed = cook(plant);
    ASSERT_EQ(packed.parts.size(), 2u);
    EXPECT_EQ(packed.parts[0].point_count, 400u);
    EXPECT_EQ(packed.parts[1].point_count, 400u);
    EXPECT_EQ(packed.bounds_plant.size().y, 0.0f);
}

TEST(CookPlant, LeavesEmptyPartsOutAndRefusesEmptyPlants) {
    PlantDescription plant;
    plant.name = "empty";
    auto refused = cook_plant(plant, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(refused.error().file, "empty");
    plant.parts.resize(2);
    plant.parts[0].name = "nothing";
    plant.parts[1].name = "something";
    shapes::add_triangle(plant.parts[1], vec3(0), vec3(1, 0, 0), vec3(0, 0, 1));
    Plant packed = cook(plant);
    ASSERT_EQ(packed.parts.size(), 1u);
    EXPECT_STREQ(packed.parts[0].name, "something");
}

TEST(CookPlant, RefusesMorePointsAndLinesThanItsLimit) {
    auto refusal_of = [](const PlantDescription& plant, uint32_t limit, float points_per_triangle) {
        CookSettings settings;
        settings.sampler = PointSampler::area;
        settings.points_per_triangle = points_per_triangle;
        settings.primitive_limit = limit;
        auto cooked = cook_plant(plant, settings);
        return cooked ? Error{ErrorId::inconclusive, "", "", "", ""} : cooked.error();
    };
    PlantDescription leaves;
    leaves.name = "leaves";
    leaves.parts = {shapes::leaf_cloud(50, 1, 0.1f, 1), shapes::leaf_cloud(50, 1, 0.1f, 2)};
    EXPECT_EQ(refusal_of(leaves, 12800, 64).id, ErrorId::inconclusive);
    Error refusal = refusal_of(leaves, 12799, 64);  // of both parts together
    EXPECT_EQ(refusal.id, ErrorId::limit_exceeded);
    EXPECT_EQ(refusal.fault, "12800 points");
    EXPECT_EQ(refusal.file, "leaves");

    PlantDescription stems;
    stems.name = "stems";
    stems.parts.resize(2);
    for (PartDescription& part : stems.parts)
        for (int i = 0; i < 3; ++i)
            shapes::add_tube(part, shapes::straight_path(vec3(float(i), 0, 0), vec3(float(i), 1, 0), 4),
                             std::vector<float>(4, 0.01f));
    EXPECT_EQ(refusal_of(stems, 1000, 2).id, ErrorId::inconclusive);
    EXPECT_EQ(refusal_of(stems, 5, 2).id, ErrorId::limit_exceeded);
}

// What the importer left out counts as well.
TEST(CookPlant, CountsDroppedVerticesOfBothStages) {
    PlantDescription plant;
    plant.name = "one";
    plant.parts.emplace_back();
    shapes::add_triangle(plant.parts[0], vec3(0), vec3(1, 0, 0), vec3(0, 0, 1));
    shapes::add_vertex(plant.parts[0], vec3(0), vec3(0, 1, 0));
    plant.dropped_vertices = 10;
    EXPECT_EQ(cook(plant).dropped_vertices, 11u);
}

TEST(CookPlant, RefusesSettingsThatCannotBeMeant) {
    PlantDescription tree = small_tree();
    for (float count : {0.0f, -1.0f, 65.0f, NAN}) {
        CookSettings settings;
        settings.points_per_triangle = count;
        EXPECT_FALSE(cook_plant(tree, settings));
    }
}

}  // namespace
}  // namespace coppice
