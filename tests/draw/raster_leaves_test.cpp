// Leaves of a crown at a level of detail, drawn by their kernel.
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/draw/scene_geometry.h"
#include "plugins/vegetation/plant/leaf_bands.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

class RasterLeaves : public RasterTest {
  protected:
    // A ball of bent quads, 10 m in front of the viewer, and at most 80 px wide.
    void SetUp() override {
        RasterTest::SetUp();
        PlantDescription description;
        description.name = "ball";
        PartDescription& part = description.parts.emplace_back();
        part.leaf = true;
        Random random(4);
        auto any = [&random](float reach) {
            return vec3(random.next_in(-reach, reach), random.next_in(-reach, reach), random.next_in(-reach, reach));
        };
        for (int i = 0; i < 600; ++i) {
            const vec3 middle = any(2.8f), u = any(0.3f), v = any(0.3f);
            for (vec3 corner : {u, v, -u, -v})
                part.vertices.push_back({middle + corner + any(0.05f), vec3(0, 1, 0), vec3(0.3f)});
            for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) part.indices.push_back(uint32_t(4 * i) + k);
        }
        auto bytes = cook_plant(description, {});
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        auto plant = load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(*bytes)), "ball");
        ASSERT_TRUE(plant) << to_string(plant.error());
        plant_ = std::move(*plant);
        ASSERT_EQ(plant_.crowns.size(), 1u);
        Scene scene;
        scene.models.resize(1);
        auto geometry = gather_geometry(scene, std::span(&plant_, 1));
        ASSERT_TRUE(geometry);
        geometry_ = std::move(*geometry);
        ASSERT_TRUE(rasteriser_->set_geometry({geometry_.vertices, geometry_.owners}));
    }

    struct Placed {
        vec3 place;
        uint32_t leaves;
    };
    void draw_plants(const std::vector<Placed>& plants) {
        work_.begin(1);
        for (const Placed& plant : plants) {
            PartChoice choice;
            choice.leaves = plant.leaves;
            work_.part(0).add(geometry_.part_geometry[0], choice, work_.part(0).add_instance(instance_at(plant.place)));
        }
        draw_work();
    }

    Plant plant_;
    SceneGeometry geometry_;
};

TEST_F(RasterLeaves, CoverWhatTheirTrianglesCover) {
    const PackedCrown crown = plant_.crowns[0];
    const LeafGrid grid = leaf_grid(plant_.parts[0]);
    for (uint32_t count : {crown.full_count, 450u, 301u, 300u, 131u, crown.least_count}) {
        std::vector<PackedVertex> triangles;
        const LeafRun run = leaves_of_level(crown.full_count, crown.least_count, count);
        for (uint32_t i = run.first; i < run.first + run.count; ++i) {
            const PackedLeaf& leaf = plant_.leaves[i];
            if (leaf.birth_level > crown.full_count - count) continue;
            for (size_t k : {0u, 1u, 2u, 0u, 2u, 3u}) {
                const vec3 steps(leaf.corners[3 * k], leaf.corners[3 * k + 1], leaf.corners[3 * k + 2]);
                const vec3 corner = grid.origin_plant + grid.step_m * steps;
                triangles.push_back({corner.x, corner.y, corner.z, leaf.surface});
            }
        }
        ASSERT_EQ(triangles.size(), 6u * count);
        ASSERT_TRUE(rasteriser_->set_geometry({geometry_.vertices, geometry_.owners}));
        draw_plants({{vec3(0, 0, -10), count}});
        EXPECT_EQ(work_.part(0).leaves, count);
        const std::vector<uint64_t> leaves = words_;
        work_.begin(1);
        PartChoice choice;
        choice.triangles = 2 * count;
        work_.part(0).add({}, choice, work_.part(0).add_instance(instance_at(vec3(0, 0, -10))));
        ASSERT_TRUE(rasteriser_->set_geometry({triangles, {}}));
        draw_work();
        size_t differ = 0;
        for (size_t i = 0; i < words_.size(); ++i) {
            const float depth = std::bit_cast<float>(uint32_t(leaves[i] >> 32)),
                        expected = std::bit_cast<float>(uint32_t(words_[i] >> 32));
            differ += !(std::fabs(depth - expected) <= 1e-3f * expected);
        }
        EXPECT_GT(covered(), 500u);
        // Corners a rounding error away from a pixel's centre.
        EXPECT_LE(differ, covered() / 500) << count;
    }
}

// One list of leaves for all plants, and each takes its own level from it.
TEST_F(RasterLeaves, PlantsOfOneModelAtSeveralLevelsAreDrawnAsIfEachWereAlone) {
    const PackedCrown crown = plant_.crowns[0];
    std::vector<Placed> plants;
    for (uint32_t i = 0; i < 12; ++i)
        plants.push_back({vec3(float(i % 4) * 5.0f - 7.5f, float(i / 4) * 5.0f - 5.0f, -11.0f - float(i)),
                          crown.least_count + (crown.full_count - crown.least_count) * i / 11});
    std::vector<uint64_t> alone(size_t(k_side) * k_side, 0);
    for (const Placed& plant : plants) {
        draw_plants({plant});
        for (size_t i = 0; i < alone.size(); ++i) alone[i] = std::max(alone[i], words_[i]);
    }
    draw_plants(plants);
    EXPECT_TRUE(words_ == alone);
    EXPECT_GT(covered(), 5000u);
}

TEST_F(RasterLeaves, AroundTheViewerAndOutsideThePictureDoNoHarm) {
    const PackedCrown crown = plant_.crowns[0];
    draw_plants({{vec3(0), crown.full_count}, {vec3(0, 0, 50), 100}, {vec3(1e5f, 0, -10), 100}, {vec3(0, -40, -3), 30}});
    for (uint64_t word : words_) EXPECT_LE(std::bit_cast<float>(uint32_t(word >> 32)), 1.0f);
}

}  // namespace
}  // namespace coppice
