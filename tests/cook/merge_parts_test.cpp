#include "plugins/vegetation/cook/merge_parts.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/cook/trace_lines.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/jobs.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

constexpr vec3 k_green(0.05f, 0.2f, 0.02f), k_red(0.6f, 0.02f, 0.02f);

CookPart leaf_part(vec3 color, float side_m = 0.1f, float importance = 0.0f) {
    CookPart part;
    part.shape.part.kind = PartKind::points;
    part.shape.part.leaf = true;
    part.shape.part.importance = importance;
    shapes::add_quad(part.shape.part, vec3(0), vec3(side_m, 0, 0), vec3(0, 0, side_m), color);
    part.area_m2 = double(side_m) * double(side_m);
    part.mean_color_linear = color;
    return part;
}

CookPart stem_part(float radius_m) {
    CookPart part;
    part.shape.part.kind = PartKind::lines;
    shapes::add_tube(part.shape.part, {vec3(0), vec3(0, 1, 0)}, {radius_m, radius_m}, 6, vec3(0.1f));
    part.shape.skeleton.segments = {{vec3(0), vec3(0, 1, 0), radius_m, radius_m, 3, 0, vec3(0.1f)}};
    part.shape.skeleton.triangle_segment.assign(part.shape.part.indices.size() / 3, 0);
    part.closed = true;
    part.area_m2 = double(2 * k_pi * radius_m);
    part.mean_color_linear = vec3(0.1f);
    return part;
}

size_t triangle_count(const std::vector<CookPart>& parts) {
    size_t count = 0;
    for (const CookPart& part : parts) count += part.shape.part.indices.size() / 3;
    return count;
}

TEST(MergeParts, LeavesFewPartsAlone) {
    std::vector<CookPart> parts(k_part_limit, leaf_part(k_green));
    EXPECT_EQ(merge_parts(parts).size(), size_t(k_part_limit));
}

TEST(MergeParts, JoinsWhatLooksAlike) {
    std::vector<CookPart> parts;
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        float shade = random.next_in(0.7f, 1.3f);
        parts.push_back(leaf_part(k_green * shade));
        // Petals are few and small.
        if (i % 100 == 0) parts.push_back(leaf_part(k_red * shade, 0.02f));
        parts.push_back(stem_part(i % 2 ? 0.2f : 0.002f));
        if (i % 10 == 0) parts.push_back(leaf_part(k_green * shade, 0.1f, i % 20 ? 0.5f : 4.0f));
    }
    size_t triangles = triangle_count(parts);
    std::vector<CookPart> merged = merge_parts(parts);
    EXPECT_LE(merged.size(), size_t(k_part_limit));
    EXPECT_EQ(triangle_count(merged), triangles);
    for (const CookPart& part : merged) {
        const PartDescription& mesh = part.shape.part;
        float least_red = 1.0f, most_red = 0.0f;
        for (const DescriptionVertex& v : mesh.vertices) {
            least_red = std::min(least_red, v.color_linear.x);
            most_red = std::max(most_red, v.color_linear.x);
        }
        EXPECT_FALSE(mesh.leaf && least_red < 0.1f && most_red > 0.3f) << "a petal among leaves";
        EXPECT_EQ(mesh.kind == PartKind::lines, !mesh.leaf);
        EXPECT_EQ(part.closed, !mesh.leaf);
        EXPECT_TRUE(mesh.importance == 0.0f || mesh.importance == 0.5f || mesh.importance == 4.0f)
            << mesh.importance;
        for (uint32_t index : mesh.indices) ASSERT_LT(index, mesh.vertices.size());
        if (mesh.leaf) continue;
        const TracedSkeleton& skeleton = part.shape.skeleton;
        ASSERT_EQ(skeleton.triangle_segment.size(), mesh.indices.size() / 3);
        // Every stem is still its own, with its own triangles around it.
        EXPECT_EQ(find_stems(skeleton.segments).size(), mesh.indices.size() / 3 / 12);
        float radius_m = skeleton.segments[0].begin_radius_m;
        for (size_t t = 0; t < skeleton.triangle_segment.size(); ++t) {
            ASSERT_EQ(skeleton.triangle_segment[t], t / 12);
            ASSERT_EQ(skeleton.segments[t / 12].begin_radius_m, radius_m) << "thick and thin";
        }
    }
}

TEST(MergeParts, KeepsMeansAndClasses) {
    std::vector<CookPart> parts(100, leaf_part(k_green));
    parts.push_back(leaf_part(k_red, 0.001f));
    parts.back().shape.part.leaf = false;
    parts.push_back(leaf_part(k_green, 0.3f));
    parts.back().mean_color_linear = k_green * 3.0f;
    std::vector<CookPart> merged = merge_parts(std::move(parts), 16);
    ASSERT_EQ(merged.size(), 3u) << "equal ones join though there is room";
    double area_m2 = 0.0;
    for (const CookPart& part : merged) area_m2 += part.area_m2;
    EXPECT_NEAR(area_m2, 100 * 0.01 + 1e-6 + 0.09, 1e-6);
    EXPECT_EQ(std::count_if(merged.begin(), merged.end(), [](auto& p) { return !p.shape.part.leaf; }), 1);
}

// A file with a material or a mesh a leaf.
TEST(MergeParts, CooksAPlantOfFiveThousandParts) {
    PlantDescription plant;
    plant.name = "many";
    Random random(8);
    for (int i = 0; i < 5000; ++i) {
        PartDescription& part = plant.parts.emplace_back(
            shapes::leaf_cloud(1, 1, 0.1f, uint64_t(i), vec3(random.next_in(-1, 1), 5, 0)));
        float shade = random.next_in(0.5f, 1.5f);
        for (DescriptionVertex& v : part.vertices) v.color_linear = (i % 250 == 0 ? k_red : k_green) * shade;
    }
    auto cooked = cook_plant(plant, {});
    set_thread_limit(1);
    auto on_one_thread = cook_plant(plant, {});
    set_thread_limit(0);
    ASSERT_TRUE(cooked && on_one_thread);
    EXPECT_TRUE(*cooked == *on_one_thread);
    auto packed =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*cooked)), "many");
    ASSERT_TRUE(packed) << to_string(packed.error());
    EXPECT_LE(packed->parts.size(), size_t(k_part_limit));
    EXPECT_EQ(packed->triangle_vertices.size(), 5000u * 2 * 3);
    EXPECT_EQ(packed->points.size(), 5000u * 4);
    uint32_t important = 0;  // the red ones
    for (const PackedPart& part : packed->parts)
        if (part.importance > 1.5f) important += part.triangle_count;
    EXPECT_EQ(important, 40u);
}

}  // namespace
}  // namespace coppice
