#include "tools/accuracy/plant_picture.h"

#include <algorithm>
#include "tests/accuracy_methods/packed_shapes.h"

namespace coppice {
namespace {

using shapes::packed_plant;
using shapes::packed_vertex;

// A square of side 2 across z, at depth z, its least corner at (x, y).
std::vector<PackedVertex> square_at(float x, float y, float z, vec3 color, bool leaf = false) {
    std::vector<PackedVertex> corners;
    for (vec3 p : {vec3(x, y, z), vec3(x + 2, y, z), vec3(x + 2, y + 2, z), vec3(x, y, z),
                   vec3(x + 2, y + 2, z), vec3(x, y + 2, z)})
        corners.push_back(packed_vertex(p, vec3(0, 0, 1), color, leaf));
    return corners;
}

uint32_t covered_count(const PlantPicture& picture) {
    return uint32_t(std::count(picture.covered.begin(), picture.covered.end(), 1));
}

TEST(PlantPicture, EverySampleOfASquareIsCoveredOnce) {
    const Plant plant = packed_plant({square_at(1, 3, 0, vec3(0.25f))});
    const PlantPicture front = picture_plant(plant, 2, 0.125f);
    EXPECT_EQ(front.columns, 16u);
    EXPECT_EQ(front.rows, 16u);
    EXPECT_EQ(covered_count(front), 256u);
    // On edge nothing is left.
    EXPECT_EQ(covered_count(picture_plant(plant, 0, 0.125f)), 0u);
    EXPECT_EQ(covered_count(picture_plant(plant, 1, 0.125f)), 0u);
}

TEST(PlantPicture, TheNearestFromThePositiveSideIsSeen) {
    // The near square covers the right half of the far one and the column beside it.
    const vec3 red(1, 0, 0), green(0, 1, 0);
    for (bool far_first : {true, false}) {
        std::vector<PackedVertex> far = square_at(0, 0, -1, red), near = square_at(1, 0, 1, green, true);
        const Plant plant = far_first ? packed_plant({far, near}) : packed_plant({near, far});
        const PlantPicture picture = picture_plant(plant, 2, 1.0f);
        ASSERT_EQ(picture.columns, 3u);
        ASSERT_EQ(picture.rows, 2u);
        for (uint32_t row = 0; row < 2; ++row) {
            EXPECT_EQ(picture.surfaces[3 * row].color_linear, red);
            EXPECT_FALSE(picture.surfaces[3 * row].leaf);
            for (uint32_t column : {1u, 2u}) {
                EXPECT_EQ(picture.surfaces[3 * row + column].color_linear, green);
                EXPECT_TRUE(picture.surfaces[3 * row + column].leaf);
            }
        }
    }
}

TEST(PlantPicture, AxesFollowEachOther) {
    // One triangle in the corner of least y and least z of a box 1 by 2 by 4: along x, columns run along y, rows along
    // z.
    const Plant plant =
        packed_plant({{packed_vertex({1, 0, 0}), packed_vertex({1, 1, 0}), packed_vertex({1, 0, 1}),
                       packed_vertex({0, 2, 4}), packed_vertex({0, 2, 4}), packed_vertex({0, 2, 4})}});
    const PlantPicture picture = picture_plant(plant, 0, 0.25f);
    EXPECT_EQ(picture.columns, 8u);
    EXPECT_EQ(picture.rows, 16u);
    EXPECT_EQ(picture.covered[0], 1);
    EXPECT_EQ(picture.covered[3], 1);  // on the slanted edge, which counts
    EXPECT_EQ(picture.covered[4], 0);
    EXPECT_EQ(picture.covered[3 * 8], 1);
    EXPECT_EQ(covered_count(picture), 4u + 3 + 2 + 1);
}

TEST(PlantPicture, ColoursAreMixedOverATriangle) {
    const Plant plant = packed_plant(
        {{packed_vertex({0, 0, 0}, vec3(0, 0, 1), vec3(0)), packed_vertex({3, 0, 0}, vec3(0, 0, 1), vec3(1)),
          packed_vertex({0, 3, 0}, vec3(0, 0, 1), vec3(0))}});
    const PlantPicture picture = picture_plant(plant, 2, 1.0f);
    EXPECT_NEAR(picture.surfaces[0].color_linear.y, 0.5f / 3, 1e-5f);
    EXPECT_NEAR(picture.surfaces[1].color_linear.y, 1.5f / 3, 1e-5f);
}

}  // namespace
}  // namespace coppice
