#include <algorithm>
#include <array>
#include <set>
#include "tests/accuracy_methods/method_fixture.h"

namespace coppice {
namespace {

constexpr float k_focal_px = 600.0f;

// Corners of all triangles, whatever their order and part.
std::multiset<std::array<float, 9>> triangles_of(const Plant& plant) {
    std::multiset<std::array<float, 9>> triangles;
    for (size_t i = 0; i < plant.triangle_vertices.size(); i += 3) {
        std::array<float, 9> corners;
        for (size_t k = 0; k < 3; ++k) {
            const PackedVertex& v = plant.triangle_vertices[i + k];
            corners[3 * k] = v.x_plant, corners[3 * k + 1] = v.y_plant, corners[3 * k + 2] = v.z_plant;
        }
        triangles.insert(corners);
    }
    return triangles;
}

uint32_t line_count(const Plant& plant) {
    uint32_t count = 0;
    for (const PackedPart& part : plant.parts) count += part.line_count;
    return count;
}

TEST(Methods, AreListedOnceWithAQualityToStartFrom) {
    std::set<std::string> names;
    auto methods = make_accuracy_methods();
    ASSERT_FALSE(methods.empty());
    EXPECT_EQ(methods[0]->name(), "full, 1 sample");
    for (const auto& method : methods) {
        EXPECT_TRUE(names.insert(method->name()).second) << method->name();
        EXPECT_FALSE(method->what().empty());
        std::vector<double> qualities = method->qualities();
        ASSERT_FALSE(qualities.empty()) << method->name();
        EXPECT_NE(std::find(qualities.begin(), qualities.end(), method->default_quality()), qualities.end())
            << method->name();
        EXPECT_TRUE(std::is_sorted(qualities.begin(), qualities.end())) << method->name();
        EXPECT_EQ(method->quality_name().empty(), qualities.size() == 1) << method->name();
    }
}

TEST_F(MethodTest, FullDrawsEveryTriangleOfTheOriginal) {
    auto one = make("full, 1 sample"), four = make("full, 4 samples");
    EXPECT_EQ(one->samples_per_pixel(), 1u);
    EXPECT_EQ(four->samples_per_pixel(), 4u);
    auto drawn = four->frame({}, k_focal_px, 1.0);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->scene, &original_);
    EXPECT_FALSE(drawn->settings.level_of_detail);
}

TEST_F(MethodTest, HybridsDifferInTheirSettings) {
    auto settings_of = [this](const char* name, double quality) {
        auto drawn = make(name)->frame({}, k_focal_px, quality);
        EXPECT_TRUE(drawn);
        EXPECT_EQ(drawn->settings.sample_distance_px, float(quality));
        return drawn->settings;
    };
    FrameSettings measured = settings_of("hybrid, measured", 2.83);
    EXPECT_EQ(measured.projection, FrameSettings{}.projection);
    EXPECT_EQ(measured.splat_factor, FrameSettings{}.splat_factor);
    EXPECT_TRUE(measured.blend);
    FrameSettings printed = settings_of("hybrid, printed", 1.0);
    EXPECT_EQ(printed.projection, ProjectionMode::printed);
    EXPECT_GE(printed.splat_factor, 1.2f);
    EXPECT_LE(printed.splat_factor, 1.5f);
    EXPECT_EQ(settings_of("hybrid, isotropic", 1.0).projection, ProjectionMode::isotropic);
    EXPECT_FALSE(settings_of("hybrid, unblended", 1.0).blend);
}

TEST_F(MethodTest, RandomOrderKeepsTrianglesAndChangesTheirOrder) {
    auto method = make("hybrid, random order");
    auto drawn = method->frame({}, k_focal_px, 1.0);
    ASSERT_TRUE(drawn);
    ASSERT_EQ(drawn->scene->plants.size(), original_.plants.size());
    for (size_t i = 0; i < original_.plants.size(); ++i) {
        const Plant &before = original_.plants[i], &after = drawn->scene->plants[i];
        EXPECT_EQ(triangles_of(after), triangles_of(before));
        auto same_place = [](const PackedVertex& a, const PackedVertex& b) {
            return a.x_plant == b.x_plant && a.y_plant == b.y_plant && a.z_plant == b.z_plant;
        };
        EXPECT_FALSE(std::equal(after.triangle_vertices.begin(), after.triangle_vertices.end(),
                                before.triangle_vertices.begin(), before.triangle_vertices.end(),
                                same_place));
        EXPECT_EQ(line_count(after), line_count(before));
    }
}

TEST_F(MethodTest, PointsOnlyHasNoLinesAndTheSameTriangles) {
    auto method = make("points only");
    auto drawn = method->frame({}, k_focal_px, 1.0);
    ASSERT_TRUE(drawn);
    for (size_t i = 0; i < original_.plants.size(); ++i) {
        const Plant& plant = drawn->scene->plants[i];
        ASSERT_GT(line_count(original_.plants[i]), 0u);
        EXPECT_EQ(line_count(plant), 0u);
        for (const PackedPart& part : plant.parts) {
            EXPECT_EQ(part.kind, PackedPartKind::points);
            EXPECT_GT(part.point_count, 0u);
        }
        EXPECT_EQ(triangles_of(plant), triangles_of(original_.plants[i]));
    }
}

TEST_F(MethodTest, PlantsCookedAnotherWayStandWhereTheyStood) {
    for (const char* name : {"hybrid, random order", "points only"}) {
        auto method = make(name);
        auto drawn = method->frame({}, k_focal_px, 1.0);
        ASSERT_TRUE(drawn);
        const Scene &before = original_.scene, &after = drawn->scene->scene;
        ASSERT_EQ(after.tiles.size(), before.tiles.size());
        ASSERT_EQ(after.positions.size(), before.positions.size());
        for (size_t i = 0; i < before.positions.size(); ++i) {
            EXPECT_EQ(after.positions[i].z_tile, before.positions[i].z_tile);
            EXPECT_EQ(after.plant_models[i].model, before.plant_models[i].model);
            EXPECT_EQ(after.plant_models[i].seed, before.plant_models[i].seed);
        }
    }
}

TEST_F(MethodTest, VertexMergingDrawsFewerTrianglesFurtherAwayAndAtLowerQuality) {
    auto method = make("vertex merging");
    auto triangles = [&](const Camera& camera, double quality) {
        auto drawn = method->frame(camera, k_focal_px, quality);
        EXPECT_TRUE(drawn);
        uint64_t count = 0;
        for (const PlantModel& plant : drawn->scene->scene.plant_models)
            count += drawn->scene->plants[plant.model].triangle_vertices.size() / 3;
        return count;
    };
    uint64_t before = UINT64_MAX;
    for (double quality : method->qualities()) {
        const uint64_t count = triangles({dvec3(0, 2, 0)}, quality);
        EXPECT_LT(count, before) << quality;
        EXPECT_LT(triangles({dvec3(0, 2, 500)}, quality), count) << quality;
        before = count;
    }
}

TEST_F(MethodTest, BillboardsDrawNearPlantsWholeAndFarOnesByPoints) {
    auto method = make("crossed billboards");
    auto drawn = method->frame({dvec3(0, 2, 0)}, k_focal_px, 1.0);
    ASSERT_TRUE(drawn);
    size_t whole = 0, points = 0;
    for (const SceneTile& tile : drawn->scene->scene.tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const Plant& plant = drawn->scene->plants[drawn->scene->scene.plant_models[row].model];
            const double distance_m =
                -(tile.tile.origin_world.z + double(drawn->scene->scene.positions[row].z_tile));
            (plant.points.empty() ? whole : points) += 1;
            // A finest texel is 4.5 m / 128: one pixel at 600 pixels a metre and 21 m.
            EXPECT_TRUE(plant.points.empty() || distance_m >= 16.0) << distance_m;
            EXPECT_TRUE(!plant.points.empty() || distance_m <= 32.0) << distance_m;
        }
    EXPECT_GT(whole, 0u);
    EXPECT_GT(points, 5u);
}

TEST_F(MethodTest, AMissingSourceIsSaid) {
    MethodScene broken = original_;
    broken.scene.models[1].source_path = (dir_ / "none.json").string();
    for (auto& method : make_accuracy_methods()) {
        if (method->name() != "points only") continue;
        Status ready = method->prepare({&broken, input().cache_dir, &k_tree_modeller, nullptr});
        ASSERT_FALSE(ready);
        EXPECT_EQ(ready.error().id, ErrorId::file_missing);
    }
}

}  // namespace
}  // namespace coppice
