// The scene made for a plant: what is seen of it along the flight, for plants of a millimetre to 100 m.
#include "plugins/vegetation/eco/plant_scene.h"

#include <algorithm>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/make_tiles.h"

namespace coppice {
namespace {

constexpr uint32_t k_picture_px = 720;

// Pixels that `size_m` takes up at the plant's place.
float height_px(const Camera& camera, float size_m) {
    float half_rad = 0.5f * camera.vertical_fov_rad;
    float focal_px = 0.5f * float(k_picture_px) * portable_cos(half_rad) / portable_sin(half_rad);
    return size_m * focal_px / float(camera.position_world.z);
}

Scene make(const Box& bounds) {
    auto scene = make_plant_scene("a/oak.glb", bounds, k_picture_px, nullptr);
    EXPECT_TRUE(scene) << to_string(scene.error());
    if (!scene) return {};
    finish_tiles(*scene, std::span(&bounds, 1));
    return std::move(*scene);
}

TEST(PlantScene, PlantFilesAreKnownByTheirEnding) {
    for (const char* plant : {"a.glb", "a/b.GLTF", "oak.json", "oak.plant"})
        EXPECT_TRUE(is_plant_file(plant)) << plant;
    for (const char* other : {"a.eco.json", "glb", "a.glb.txt", ""})
        EXPECT_FALSE(is_plant_file(other)) << other;
}

TEST(PlantScene, FliesFromAFullPictureToTwentyPixels) {
    for (float height_m : {0.001f, 0.2f, 15.0f, 100.0f}) {
        Scene scene = make({vec3(-0.3f, 0.0f, -0.3f) * height_m, vec3(0.3f, 1.0f, 0.3f) * height_m});
        const Camera &near = scene.camera_path.front().camera, &far = scene.camera_path.back().camera;
        EXPECT_GT(height_px(near, height_m), 0.5f * k_picture_px) << height_m;
        EXPECT_LT(height_px(near, height_m), 1.0f * k_picture_px) << height_m;
        EXPECT_NEAR(height_px(far, height_m), 20.0f, 0.5f) << height_m;
        for (const CameraKey& key : scene.camera_path) {
            vec3 to_plant(0.0f, 0.5f * height_m - float(key.camera.position_world.y),
                          -float(key.camera.position_world.z));
            EXPECT_GT(glm::dot(glm::normalize(to_plant), key.camera.forward()), 0.999f) << "looks elsewhere";
            EXPECT_LT(key.camera.near_m, glm::length(to_plant) - 0.3f * height_m) << "cuts the plant";
        }
        ASSERT_EQ(scene.name, "oak");
        EXPECT_GT(scene.positions.size(), 100u);
    }
}

// Models have their origin anywhere: the middle of the box, a corner, far off.
TEST(PlantScene, ThePlantStandsOnTheGroundAloneInFront) {
    const Box centred{vec3(-2, -5, -2), vec3(2, 5, 2)}, far_off{vec3(98, 3, -52), vec3(102, 13, -48)};
    for (const Box& bounds : {centred, far_off}) {
        Scene scene = make(bounds);
        double front_z = -INFINITY;
        int in_front = 0;
        for (const SceneTile& tile : scene.tiles)
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
                const PlantPosition& p = scene.positions[row];
                vec3 foot(bounds.center().x, bounds.min.y, bounds.center().z);
                dvec3 spot = tile.tile.origin_world + dvec3(p.x_tile, p.y_tile, p.z_tile) +
                             dvec3(rotation_matrix(scene.turns[row]) * foot * p.scale);
                EXPECT_NEAR(spot.y, 0.0, 0.01);
                front_z = std::max(front_z, spot.z);
                in_front += spot.z > -4.0;
            }
        EXPECT_NEAR(front_z, 0.0, 0.02);
        EXPECT_EQ(in_front, 1);
    }
}

TEST(PlantScene, ACarpetIsSeenByItsWidth) {
    Scene scene = make({vec3(-3, 0, -3), vec3(3, 0, 3)});
    double near_m = scene.camera_path.front().camera.position_world.z;
    EXPECT_GT(near_m, 3.0) << "in front of it, not within";
    EXPECT_GT(scene.camera_path.back().camera.position_world.z, near_m);
}

}  // namespace
}  // namespace coppice
