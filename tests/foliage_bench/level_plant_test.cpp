// A level of a crown as a plant: its leaves in place of the plant's, the wood as it was.
#include "tools/foliage/level_plant.h"

#include "tests/accuracy_methods/packed_shapes.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

Plant wood_and_leaves() {
    const std::vector<PackedVertex> triangle{shapes::packed_vertex(vec3(0)),
                                             shapes::packed_vertex(vec3(1, 0, 0)),
                                             shapes::packed_vertex(vec3(0, 1, 0))};
    const Plant plain = shapes::packed_plant({triangle, triangle, triangle});
    PlantBlocks blocks;
    blocks.name = "tree";
    blocks.bounds_plant = plain.bounds_plant;
    for (size_t i = 0; i < 3; ++i) {
        PackedPart part = plain.parts[i];
        if (i > 0) part.flags |= k_part_leaf;
        add_triangle_part(part, triangle, blocks);
    }
    auto plant = pack_substitute(blocks);
    EXPECT_TRUE(plant) << to_string(plant.error());
    return std::move(*plant);
}

TEST(LevelPlant, LeavesTakeThePlaceOfAllLeafParts) {
    const Plant plant = wood_and_leaves();
    const std::vector<Leaf> leaves = made_crown(17, 1);
    const OpennessGrid openness({}, {});
    for (bool with_wood : {true, false}) {
        const auto level = make_level_plant(plant, leaves, openness, with_wood);
        ASSERT_TRUE(level) << to_string(level.error());
        ASSERT_EQ(level->parts.size(), with_wood ? 2u : 1u);
        const PackedPart& crown = level->parts.back();
        EXPECT_TRUE(crown.flags & k_part_leaf);
        EXPECT_EQ(crown.triangle_count, 34u);
        double area_m2 = 0.0;
        for (const Leaf& leaf : leaves) area_m2 += leaf_area_m2(leaf);
        EXPECT_NEAR(double(crown.area_m2), area_m2, 1e-6);
        const Surface first =
            decode_surface(level->triangle_vertices[3 * size_t(crown.first_triangle)].surface);
        EXPECT_GT(glm::dot(first.normal, leaves[0].normal_plant), 0.99f);
        EXPECT_TRUE(first.leaf);
    }
}

}  // namespace
}  // namespace coppice
