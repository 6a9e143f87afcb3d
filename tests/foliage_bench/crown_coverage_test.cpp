// Coverage errors are those of crowns whose coverage is known.
#include "tools/foliage/crown_coverage.h"

#include <gtest/gtest.h>
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

// The six faces of a cube about the origin: from everywhere it covers as much as the square of its side.
std::vector<Leaf> cube(float side_m) {
    std::vector<Leaf> faces;
    for (int axis = 0; axis < 3; ++axis)
        for (float sign : {-1.0f, 1.0f}) {
            vec3 normal(0.0f), x(0.0f), y(0.0f);
            normal[axis] = sign;
            x[(axis + 1) % 3] = y[(axis + 2) % 3] = 1.0f;
            Leaf face{{normal - x - y, normal + x - y, normal + x + y, normal - x + y}, normal, vec3(0.1f)};
            for (vec3& corner : face.corners_plant) corner = corner * (0.5f * side_m);
            faces.push_back(face);
        }
    return faces;
}

TEST(CrownCoverage, KnowsWhatIsMissingAndWhatIsTooMuch) {
    const std::vector<Leaf> full = cube(1.0f);
    const CrownCoverage coverage(full);
    EXPECT_EQ(coverage.worst_error(full), 0.0);
    EXPECT_NEAR(coverage.worst_error(cube(0.9f)), 0.19, 0.005);
    EXPECT_NEAR(coverage.worst_error(cube(1.1f)), 0.21, 0.005);
    EXPECT_EQ(coverage.worst_error({}), 1.0);
}

TEST(CrownCoverage, NothingIsComparedWithNothing) {
    EXPECT_EQ(CrownCoverage({}).worst_error(made_crown(10, 1)), 0.0);
    const std::vector<Leaf> points(3, Leaf{{}, vec3(0, 1, 0), vec3(0.1f)});
    EXPECT_EQ(CrownCoverage(points).worst_error(points), 0.0);
}

}  // namespace
}  // namespace coppice
