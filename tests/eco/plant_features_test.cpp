#include "plugins/vegetation/eco/plant_features.h"

#include <cmath>
#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr vec3 k_green(0.1f, 0.4f, 0.2f);

// A parallelogram of two triangles.
void add_sheet(PartDescription& part, vec3 corner, vec3 along, vec3 across, vec3 color = k_green) {
    const uint32_t first = uint32_t(part.vertices.size());
    const vec3 normal = normalize_or(glm::cross(along, across), vec3(0, 1, 0));
    for (vec3 at : {corner, corner + along, corner + along + across, corner + across})
        part.vertices.push_back({at, normal, color});
    for (uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) part.indices.push_back(first + i);
}

PartDescription leaf_part() {
    PartDescription part;
    part.leaf = true;
    return part;
}

// A crown of 100 square metres: 10 m high, 2 m above the ground, on a stem of one square metre a side.
PlantDescription small_tree() {
    PlantDescription plant;
    plant.parts = {leaf_part(), {}};
    add_sheet(plant.parts[0], {-5, 2, 0}, {10, 0, 0}, {0, 10, 0});
    add_sheet(plant.parts[1], {0, 0, 1}, {0, 4, 0}, {0.25f, 0, 0}, vec3(0.3f));
    add_sheet(plant.parts[1], {0, 0, 2}, {0, 4, 0}, {0.25f, 0, 0}, vec3(0.3f));
    return plant;
}

TEST(PlantFeatures, MeasureWhatIsThere) {
    const PlantFeatures f = measure_features(small_tree());
    EXPECT_FLOAT_EQ(f.height_m, 12.0f);
    EXPECT_FLOAT_EQ(f.crown_width_x_m, 10.0f);
    EXPECT_FLOAT_EQ(f.crown_width_z_m, 0.0f);
    EXPECT_FLOAT_EQ(f.area_along_x_m2, 0.0f);
    EXPECT_FLOAT_EQ(f.area_along_y_m2, 0.0f);
    EXPECT_FLOAT_EQ(f.area_along_z_m2, 101.0f);  // half of the stem's two sides
    EXPECT_FLOAT_EQ(f.leaf_area_m2, 100.0f);
    EXPECT_FLOAT_EQ(f.leaf_red, k_green.x);
    EXPECT_FLOAT_EQ(f.leaf_green, k_green.y);
    EXPECT_FLOAT_EQ(f.leaf_blue, k_green.z);
}

TEST(PlantFeatures, ALowTwigIsNotTheCrownsBase) {
    PlantDescription plant;
    plant.parts = {leaf_part()};
    for (int i = 0; i < 100; ++i)
        add_sheet(plant.parts[0], {0, 4.0f + 0.06f * float(i), 0}, {1, 0, 0}, {0, 0, 1});
    EXPECT_NEAR(measure_features(plant).crown_base_m, 4.3f, 0.1f);
    add_sheet(plant.parts[0], {0, 0.5f, 0}, {1, 0, 0}, {0, 0, 1});
    EXPECT_NEAR(measure_features(plant).crown_base_m, 4.25f, 0.1f);
}

TEST(PlantFeatures, FollowAPlantsSize) {
    PlantDescription plant = small_tree();
    const PlantFeatures small = measure_features(plant);
    for (PartDescription& part : plant.parts)
        for (DescriptionVertex& vertex : part.vertices) vertex.position_plant *= 2.0f;
    const PlantFeatures large = measure_features(plant);
    EXPECT_FLOAT_EQ(large.height_m, 2.0f * small.height_m);
    EXPECT_FLOAT_EQ(large.crown_base_m, 2.0f * small.crown_base_m);
    EXPECT_FLOAT_EQ(large.crown_width_x_m, 2.0f * small.crown_width_x_m);
    EXPECT_FLOAT_EQ(large.area_along_z_m2, 4.0f * small.area_along_z_m2);
    EXPECT_FLOAT_EQ(large.leaf_area_m2, 4.0f * small.leaf_area_m2);
    EXPECT_FLOAT_EQ(large.leaf_green, small.leaf_green);
}

TEST(PlantFeatures, ColourIsWeighedByArea) {
    PlantDescription plant;
    plant.parts = {leaf_part()};
    add_sheet(plant.parts[0], {0, 0, 0}, {3, 0, 0}, {0, 1, 0}, vec3(1.0f, 0.0f, 0.0f));
    add_sheet(plant.parts[0], {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, vec3(0.0f, 1.0f, 0.0f));
    const PlantFeatures f = measure_features(plant);
    EXPECT_FLOAT_EQ(f.leaf_red, 0.75f);
    EXPECT_FLOAT_EQ(f.leaf_green, 0.25f);
    EXPECT_FLOAT_EQ(f.area_along_x_m2, 1.0f);
    EXPECT_FLOAT_EQ(f.area_along_z_m2, 3.0f);
}

TEST(PlantFeatures, StemsAreTheCrownOfAPlantWithoutLeaves) {
    PlantDescription plant = small_tree();
    plant.parts.erase(plant.parts.begin());
    const PlantFeatures f = measure_features(plant);
    EXPECT_FLOAT_EQ(f.height_m, 4.0f);
    EXPECT_FLOAT_EQ(f.crown_width_x_m, 0.25f);
    EXPECT_FLOAT_EQ(f.crown_width_z_m, 1.0f);
    EXPECT_EQ(f.leaf_area_m2, 0.0f);
    EXPECT_EQ(f.leaf_red + f.leaf_green + f.leaf_blue, 0.0f);
}

TEST(PlantFeatures, AreNumbersWhateverThePlant) {
    PlantDescription broken = small_tree();
    add_sheet(broken.parts[0], {NAN, 0, 0}, {1, 0, 0}, {0, 1, 0});
    add_sheet(broken.parts[0], {0, 0, 0}, {INFINITY, 0, 0}, {0, 1, 0});
    add_sheet(broken.parts[0], {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, vec3(NAN));
    const PlantFeatures f = measure_features(broken);
    EXPECT_FLOAT_EQ(f.leaf_area_m2, 100.0f);
    EXPECT_FLOAT_EQ(f.leaf_green, k_green.y);
    const PlantFeatures none = measure_features({});
    EXPECT_GT(none.height_m, 0.0f);
    EXPECT_EQ(none.crown_base_m, 0.0f);
    EXPECT_EQ(none.crown_width_x_m, 0.0f);
    EXPECT_EQ(none.area_along_y_m2, 0.0f);
}

}  // namespace
}  // namespace coppice
