#include "plugins/modeller/leaf_shapes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace coppice::modeller {
namespace {

constexpr LeafShape k_shapes[] = {LeafShape::rhombic, LeafShape::ovate, LeafShape::lanceolate,
                                  LeafShape::birch,   LeafShape::oak,   LeafShape::heart,
                                  LeafShape::spoon,   LeafShape::petal};

float area_of(const LeafMesh& mesh, bool& upwards) {
    float area = 0.0f;
    upwards = true;
    for (const auto& t : mesh.triangles) {
        vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        vec3 cross = glm::cross(b - a, c - a);
        area += 0.5f * glm::length(cross);
        upwards = upwards && cross.z > 0.0f;
    }
    return area;
}

TEST(LeafShapes, flat_leaves_have_their_width_and_face_up) {
    for (LeafShape shape : k_shapes) {
        LeafMesh mesh = make_leaf_mesh(shape, 0.6f, 0.0f, 0.0f);
        bool upwards = false;
        float area = area_of(mesh, upwards);
        EXPECT_TRUE(upwards) << int(shape);
        EXPECT_GT(area, 0.2f * 0.6f) << int(shape);
        EXPECT_LT(area, 0.8f * 0.6f) << int(shape);
        float left = 0, right = 0;
        for (vec3 p : mesh.positions) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
        }
        EXPECT_NEAR(right, 0.3f, 1e-5f) << int(shape);
        EXPECT_NEAR(left, -0.3f, 1e-5f) << int(shape);
        EXPECT_EQ(mesh.triangles.size(), triangles_of_leaf(shape, 6)) << int(shape);
    }
    EXPECT_EQ(triangles_of_leaf(LeafShape::needles, 6), 6u);
}

TEST(LeafShapes, folding_and_curving_keep_the_area) {
    for (LeafShape shape : k_shapes) {
        bool unused;
        float flat = area_of(make_leaf_mesh(shape, 0.6f, 0, 0), unused);
        float folded = area_of(make_leaf_mesh(shape, 0.6f, 0.4f, 0), unused);
        float curved = area_of(make_leaf_mesh(shape, 0.6f, 0.0f, 0.6f), unused);
        EXPECT_NEAR(folded, flat, 0.01f * flat) << int(shape);
        EXPECT_NEAR(curved, flat, 0.08f * flat) << int(shape);
    }
}

TEST(LeafShapes, a_positive_curve_lowers_the_tip) {
    for (LeafShape shape : k_shapes) {
        LeafMesh mesh = make_leaf_mesh(shape, 0.5f, 0.0f, 0.8f);
        size_t tip = size_t(std::max_element(mesh.along.begin(), mesh.along.end()) - mesh.along.begin());
        EXPECT_LT(mesh.positions[tip].z, -0.2f) << int(shape);
        for (vec3 n : mesh.normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
    }
}

}  // namespace
}  // namespace coppice::modeller
