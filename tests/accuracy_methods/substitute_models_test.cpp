#include "tools/accuracy/substitute_models.h"

#include <set>
#include "plugins/vegetation/lod/choose_part.h"
#include "tests/accuracy_methods/method_fixture.h"

namespace coppice {
namespace {

constexpr float k_focal_px = 600.0f;

class SubstituteTest : public MethodTest {
  protected:
    // Level l of every model has a grain of 0, 0.01, 0.02, 0.04, ... m and is the full geometry all the same.
    SubstituteScenes make_scenes(size_t level_count) const {
        std::vector<SubstituteLadder> ladders;
        for (const Plant& plant : original_.plants) {
            SubstituteLadder& ladder = ladders.emplace_back();
            for (size_t l = 0; l < level_count; ++l)
                ladder.push_back({*triangles_only(plant), l == 0 ? 0.0f : 0.005f * float(1u << l)});
        }
        return SubstituteScenes(original_, std::move(ladders));
    }
    // Levels of the plants, nearest first: the fixture puts them at growing distances.
    std::vector<uint32_t> levels(const MethodScene& scene, uint32_t level_count) const {
        std::vector<std::pair<double, uint32_t>> found;
        for (const SceneTile& tile : scene.scene.tiles)
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row)
                found.emplace_back(-(tile.tile.origin_world.z + double(scene.scene.positions[row].z_tile)),
                                   scene.scene.plant_models[row].model % level_count);
        std::sort(found.begin(), found.end());
        std::vector<uint32_t> levels;
        for (auto& [distance, level] : found) levels.push_back(level);
        return levels;
    }
};

TEST_F(SubstituteTest, TrianglesOnlyIsDrawnWholeAtAnyDistance) {
    auto plant = triangles_only(original_.plants[0]);
    ASSERT_TRUE(plant);
    FrameSettings settings;
    settings.projection = ProjectionMode::printed;
    settings.sample_distance_px = 16.0f;
    uint32_t triangles = 0;
    for (const PackedPart& part : plant->parts)
        for (float pixels : {1e-3f, 1.0f, 1e4f}) {
            const PartChoice choice = choose_part(part, {vec3(0, 0, -1), pixels}, settings, 0.5f);
            EXPECT_EQ(choice.triangles, part.triangle_count);
            EXPECT_EQ(choice.points + choice.lines, 0u);
            if (pixels == 1.0f) triangles += part.triangle_count;
        }
    EXPECT_EQ(triangles, original_.plants[0].triangle_vertices.size() / 3);
}

TEST_F(SubstituteTest, LevelsGrowWithDistanceAndQuality) {
    SubstituteScenes scenes = make_scenes(8);
    const Camera camera{dvec3(0, 2, 0)};
    std::vector<uint32_t> fine = levels(*scenes.choose(camera, k_focal_px, 1.0).scene, 8);
    ASSERT_EQ(fine.size(), 12u);
    EXPECT_TRUE(std::is_sorted(fine.begin(), fine.end()));
    EXPECT_EQ(fine.front(), 0u);
    EXPECT_GE(std::set<uint32_t>(fine.begin(), fine.end()).size(), 5u);
    std::vector<uint32_t> coarse = levels(*scenes.choose(camera, k_focal_px, 2.0).scene, 8);
    for (size_t i = 0; i < fine.size(); ++i) EXPECT_GE(coarse[i], fine[i]);
    EXPECT_NE(coarse, fine);
}

TEST_F(SubstituteTest, NoGrainIsLargerOnTheScreenThanAskedFor) {
    SubstituteScenes scenes = make_scenes(8);
    const MethodScene& drawn = *scenes.choose({dvec3(0, 2, 0)}, k_focal_px, 1.5).scene;
    for (const SceneTile& tile : drawn.scene.tiles)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& place = drawn.scene.positions[row];
            const double foot_m = -(tile.tile.origin_world.z + double(place.z_tile));
            const uint32_t level = drawn.scene.plant_models[row].model % 8;
            const double grain_m = level == 0 ? 0.0 : 0.005 * double(1u << level) * double(place.scale);
            // Crowns are 3 m wide at most: what is drawn is hardly nearer than that before the foot.
            EXPECT_LE(grain_m * double(k_focal_px) / (foot_m + 2.0), 1.5);
            // And none is needlessly fine: the next level's grain would be larger than asked for, even seen from
            // afar.
            if (level > 0 && level < 7 && foot_m > 50.0) {
                EXPECT_GT(2.0 * grain_m * double(k_focal_px) / (foot_m - 4.0), 1.5);
            }
        }
}

TEST_F(SubstituteTest, PositionsTilesAndSeedsStay) {
    SubstituteScenes scenes = make_scenes(4);
    const Scene& after = scenes.choose({dvec3(0, 2, 0)}, k_focal_px, 4.0).scene->scene;
    const Scene& before = original_.scene;
    ASSERT_EQ(after.models.size(), 2u * 4);
    ASSERT_EQ(after.tiles.size(), before.tiles.size());
    for (size_t t = 0; t < before.tiles.size(); ++t) {
        EXPECT_EQ(after.tiles[t].first_plant, before.tiles[t].first_plant);
        EXPECT_EQ(after.tiles[t].plant_count, before.tiles[t].plant_count);
        EXPECT_EQ(after.tiles[t].tile.origin_world, before.tiles[t].tile.origin_world);
        EXPECT_EQ(after.tiles[t].tile.bounds_tile.max, before.tiles[t].tile.bounds_tile.max);
    }
    ASSERT_EQ(after.positions.size(), before.positions.size());
    for (size_t i = 0; i < before.positions.size(); ++i) {
        EXPECT_EQ(after.positions[i].x_tile, before.positions[i].x_tile);
        EXPECT_EQ(after.positions[i].scale, before.positions[i].scale);
        EXPECT_EQ(after.turns[i].y, before.turns[i].y);
        EXPECT_EQ(after.plant_models[i].seed, before.plant_models[i].seed);
        EXPECT_EQ(after.plant_models[i].model / 4, before.plant_models[i].model);
        EXPECT_EQ(after.models[after.plant_models[i].model].importance, 1.0f);
    }
}

TEST_F(SubstituteTest, TheSameChoiceIsTheSameSceneAndAnotherHasAnotherRevision) {
    SubstituteScenes scenes = make_scenes(8);
    std::set<uint64_t> revisions;
    auto choose = [&](double grain_px) { return scenes.choose({dvec3(0, 2, 0)}, k_focal_px, grain_px); };
    const auto first = choose(0.5);
    revisions.insert(first.revision);
    // A step that changes no plant's level.
    const auto nudged = scenes.choose({dvec3(0, 2, 1e-6)}, k_focal_px, 0.5);
    EXPECT_EQ(nudged.scene, first.scene);
    EXPECT_EQ(nudged.revision, first.revision);
    for (double grain_px : {1.0, 2.0, 4.0, 8.0})
        EXPECT_TRUE(revisions.insert(choose(grain_px).revision).second);
    EXPECT_EQ(choose(0.5).scene, first.scene);  // four others later it is still there
    EXPECT_TRUE(revisions.insert(choose(16.0).revision).second);
    EXPECT_TRUE(
        revisions.insert(choose(0.5).revision).second);  // made again: the address may not tell, this does
}

}  // namespace
}  // namespace coppice
