// Cells of large plants choose for themselves where they are near, and together far away.
#include "plugins/vegetation/draw/expand_plants.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "plugins/vegetation/cook/cook_plant.h"
#include "tests/cook/shapes.h"
#include "tests/draw/expand_run.h"

namespace coppice {
namespace {

constexpr vec3 k_center(0.0f, 6.0f, 0.0f);
constexpr uint32_t k_cells = 8;  // parts [1, 9); part 0 is the crown in one piece

class ExpandCells : public ::testing::Test {
  protected:
    // A crown of 20000 leaves in eight cells, 6 m about k_center.
    static void SetUpTestSuite() {
        PlantDescription crown;
        crown.name = "crown";
        crown.parts = {shapes::leaf_cloud(20000, 6.0f, 0.1f, 3, k_center)};
        auto bytes = cook_plant(crown, {});
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        auto plant = load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)),
                                            "crown");
        ASSERT_TRUE(plant) << to_string(plant.error());
        Scene scene;
        scene.models.resize(1);
        auto gathered = gather_geometry(scene, {&*plant, 1});
        ASSERT_TRUE(gathered) << to_string(gathered.error());
        geometry_ = new SceneGeometry(std::move(*gathered));
        ASSERT_EQ(geometry_->parts.size(), 1u + k_cells);
        ASSERT_EQ(geometry_->part_cells[0].first, 1u);
        ASSERT_EQ(geometry_->part_cells[0].count, k_cells);
    }
    static void TearDownTestSuite() {
        delete geometry_;
        geometry_ = nullptr;
    }

    // Cells that all have the plant's view: what the plant was before it was cut.
    static SceneGeometry without_own_views() {
        SceneGeometry geometry = *geometry_;
        geometry.models[0].has_cells = false;
        geometry.models[0].first_part = 1;
        geometry.models[0].part_count = k_cells;
        return geometry;
    }
    static SceneGeometry only_cell(uint32_t cell) {
        SceneGeometry geometry = *geometry_;
        geometry.part_cells[0] = {cell, 1};
        return geometry;
    }
    static Frustum frustum_of(float vertical_fov_rad) {
        Camera camera;
        camera.position_world = dvec3(0.0);
        camera.vertical_fov_rad = vertical_fov_rad;
        return make_frustum(camera, 800, 600);  // along -z
    }
    // With the viewer distance_m before the crown's centre.
    static WorkList expand(const SceneGeometry& geometry, float distance_m, const FrameSettings& settings,
                           float vertical_fov_rad = 1.0f) {
        const vec3 foot = vec3(0.0f, 0.0f, -distance_m) - k_center;
        const PlantPosition position{foot.x, foot.y, foot.z, 1.0f};
        const PlantTurn turn{0, 0, 0, 32767};
        const PlantModel model{0, 5};
        WorkList work;
        work.begin(1);
        expand_run({vec3(0.0f), false, {&position, 1}, {&turn, 1}, {&model, 1}}, geometry,
                   frustum_of(vertical_fov_rad), settings, 0, seen_, work.part(0));
        return work;
    }
    static double points_a_m2(uint32_t cell, float distance_m, const FrameSettings& settings) {
        WorkList work = expand(only_cell(cell), distance_m, settings, 2.0f);
        EXPECT_EQ(work.part(0).triangles, 0u) << "the test wants points";
        return double(work.part(0).points) / double(geometry_->parts[cell].area_m2);
    }
    static float distance_of(uint32_t cell, float distance_m) {
        return glm::length(geometry_->part_spheres[cell].center_plant - k_center -
                           vec3(0.0f, 0.0f, distance_m));
    }
    static std::pair<uint32_t, uint32_t> nearest_and_farthest() {
        uint32_t nearest = 1, farthest = 1;
        for (uint32_t cell = 2; cell <= k_cells; ++cell) {
            if (distance_of(cell, 8.0f) < distance_of(nearest, 8.0f)) nearest = cell;
            if (distance_of(cell, 8.0f) > distance_of(farthest, 8.0f)) farthest = cell;
        }
        return {nearest, farthest};
    }

    static inline SceneGeometry* geometry_ = nullptr;
    static inline SeenPlants seen_;  // holds the instances of the last work list
};

FrameSettings coarse(float sample_distance_px) {
    FrameSettings settings;
    settings.sample_distance_px = sample_distance_px;
    return settings;
}

// What a scene says of a population multiplies what its parts say.
TEST_F(ExpandCells, ImportanceOfThePopulationCounts) {
    PlantDescription crown;
    crown.name = "crown";
    crown.parts = {shapes::leaf_cloud(2000, 6.0f, 0.1f, 3, k_center)};
    crown.parts[0].importance = 1.5f;
    auto bytes = cook_plant(crown, {});
    ASSERT_TRUE(bytes) << to_string(bytes.error());
    auto plant = load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "crown");
    ASSERT_TRUE(plant) << to_string(plant.error());
    Scene scene;
    scene.models.resize(1);
    scene.models[0].importance = 2.0f;
    const auto geometry = gather_geometry(scene, {&*plant, 1});
    ASSERT_TRUE(geometry);
    for (const PackedPart& part : geometry->parts) EXPECT_EQ(part.importance, 3.0f);
}

TEST_F(ExpandCells, NearOnesDrawMoreForTheirAreaThanFarOnes) {
    const auto [nearest, farthest] = nearest_and_farthest();
    EXPECT_GT(points_a_m2(nearest, 8.0f, coarse(12.0f)), 3.0 * points_a_m2(farthest, 8.0f, coarse(12.0f)));
}

TEST_F(ExpandCells, TogetherDrawFewerThanThePlantInOnePieceAtEqualDensityNearBy) {
    const uint32_t nearest = nearest_and_farthest().first;
    SceneGeometry whole = without_own_views(), whole_nearest = whole;
    whole_nearest.models[0].first_part = nearest;
    whole_nearest.models[0].part_count = 1;
    const double wanted = points_a_m2(nearest, 8.0f, coarse(12.0f));
    // The sample distance at which the plant in one piece has that density.
    float low = 12.0f, high = 1200.0f;
    auto density = [&](float d) {
        return double(expand(whole_nearest, 8.0f, coarse(d), 2.0f).part(0).points) /
               double(geometry_->parts[nearest].area_m2);
    };
    for (int i = 0; i < 40; ++i) (density(0.5f * (low + high)) > wanted ? low : high) = 0.5f * (low + high);
    ASSERT_NEAR(density(high), wanted, 0.02 * wanted);
    WorkList in_one_piece = expand(whole, 8.0f, coarse(high), 2.0f);
    WorkList in_cells = expand(*geometry_, 8.0f, coarse(12.0f), 2.0f);
    EXPECT_LT(double(in_cells.part(0).points), 0.7 * double(in_one_piece.part(0).points));
}

TEST_F(ExpandCells, FarAwayThePlantIsDrawnInOnePiece) {
    const float radius_m = geometry_->models[0].radius_m;
    std::vector<WorkInstance> instances(10);
    std::vector<WorkEntry> entries(10000);
    for (float distance_m : {6.01f * radius_m, 20.0f * radius_m}) {
        WorkList work = expand(*geometry_, distance_m, coarse(2.0f));
        const WorkList::Layout layout = work.gather(instances, entries);
        const PartGeometry& place = geometry_->part_geometry[0];
        ASSERT_GT(layout.entry_count, 0u);
        for (uint32_t e = 0; e < layout.entry_count; ++e) {
            EXPECT_GE(entries[e].first_vertex, place.first_point);
            EXPECT_LE(entries[e].first_vertex + entries[e].count, place.first_point + place.point_count);
        }
        EXPECT_EQ(layout.entry_count, (work.part(0).points + 255) / 256) << "no entry a cell";
    }
}

// Where it asks for more points than the part in one piece has.
TEST_F(ExpandCells, FarAwayCellsGoOnWhereThePartsPointsEnd) {
    const float distance_m = 6.5f * geometry_->models[0].radius_m;
    uint64_t before = 0;
    bool points_of_cells = false, triangles = false;
    for (float d = 2.0f; d > 0.02f; d *= 0.97f) {
        FrameSettings settings = coarse(d);
        settings.foliage = FoliageMode::points;
        WorkList work = expand(*geometry_, distance_m, settings);
        const uint64_t vertices = work.part(0).points + 3 * work.part(0).triangles;
        if (before > 0 && work.part(0).triangles < 40000u) {
            ASSERT_NEAR(double(vertices) / double(before), 1.0 / (0.97 * 0.97), 0.02) << d;
        }
        before = vertices;
        points_of_cells |= work.part(0).points > geometry_->parts[0].point_count;
        triangles |= work.part(0).triangles == 40000u;
    }
    EXPECT_TRUE(points_of_cells && triangles);
}

TEST_F(ExpandCells, NothingJumpsOnTheWayThere) {
    const float radius_m = geometry_->models[0].radius_m;
    const auto [nearest, farthest] = nearest_and_farthest();
    for (uint32_t cell : {nearest, farthest}) {
        double before = 0.0;
        for (float distance_m = 5.99f * radius_m; distance_m > 2.0f * radius_m; distance_m *= 0.995f) {
            const double here = points_a_m2(cell, distance_m, coarse(1.0f));
            if (before > 0.0) {
                ASSERT_NEAR(here / before, 1.01, 0.03) << distance_m;
            }
            before = here;
        }
    }
    // And where the cells take over.
    const double in_one_piece = double(expand(*geometry_, 6.01f * radius_m, coarse(1.0f)).part(0).points);
    const double in_cells = double(expand(*geometry_, 5.99f * radius_m, coarse(1.0f)).part(0).points);
    EXPECT_NEAR(in_cells / in_one_piece, 1.0, 0.02);
}

TEST_F(ExpandCells, DrawNothingOutsideTheView) {
    FrameSettings every_triangle;
    every_triangle.level_of_detail = false;
    const Frustum frustum = frustum_of(0.3f);
    for (float distance_m : {8.0f, 0.0f, -4.0f}) {
        uint64_t in_view = 0;
        for (uint32_t cell = 1; cell <= k_cells; ++cell) {
            const PartSphere& sphere = geometry_->part_spheres[cell];
            const vec3 place = sphere.center_plant - k_center - vec3(0.0f, 0.0f, distance_m);
            if (sees_sphere(frustum, place, sphere.radius_m))
                in_view += geometry_->parts[cell].triangle_count;
        }
        WorkList work = expand(*geometry_, distance_m, every_triangle, 0.3f);
        EXPECT_EQ(work.part(0).triangles, in_view) << distance_m;
        if (distance_m < 0.0f) {
            EXPECT_LT(in_view, 40000u) << "the cells behind the viewer";
        } else if (distance_m > 0.0f) {
            EXPECT_EQ(in_view, 40000u);
        }
    }
}

}  // namespace
}  // namespace coppice
