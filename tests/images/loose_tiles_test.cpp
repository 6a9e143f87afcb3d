// Plants that a host changes while they are drawn look as those of the scene do.
#include "tests/images/hills.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/shadow/clipmap.h"

namespace coppice {
namespace {

constexpr uint32_t k_width = 200, k_height = 120, k_tile_limit = 40;
// Where two surfaces are equally near, the one that was listed first is drawn; lists are by rows.
constexpr size_t k_tie_limit = 12;

struct LooseTiles : testing::Test {
    void SetUp() override {
        scene_.path = "loose";
        for (const char* name : {"fern", "daisy"}) {
            auto plant = cook_species(name);
            ASSERT_TRUE(plant) << to_string(plant.error());
            plants_.push_back(std::move(*plant));
            scene_.models.push_back({name, name, 0, 1.0f});
        }
        std::vector<Placement> placements;
        Random random(5);
        for (uint32_t i = 0; i < 2600; ++i)
            placements.push_back({dvec3(random.next_in(-20.0f, 20.0f), random.next_in(-1.0f, 1.0f),
                                        random.next_in(-60.0f, -3.0f)),
                                  random.next_in(1.0f, 4.0f),
                                  pack_turn_about_y(random.next_in(0.0f, 6.0f)),
                                  {random.next_below(2), uint32_t(random.next_bits())}});
        make_tiles(placements, scene_);
        finish_tiles(scene_, std::vector<Box>{plants_[0].bounds_plant, plants_[1].bounds_plant});
        scene_.camera_path.push_back({});
        empty_ = scene_;
        empty_.tiles.clear();
        empty_.positions.clear();
        empty_.turns.clear();
        empty_.plant_models.clear();
        ASSERT_GT(scene_.tiles.size(), 3u);
        ASSERT_LE(scene_.tiles.size(), k_tile_limit);

        ASSERT_TRUE(registry_.load("vegetation"));
        const auto* interface =
            registry_.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
        auto device = gpu::Device::create({});
        ASSERT_TRUE(device) << to_string(device.error());
        device_ = std::move(*device);
        auto ring = gpu::CommandRing::create(*device_, 2);
        ASSERT_TRUE(ring);
        ring_ = std::move(*ring);
        VegetationSettings settings{device_.get(), &world_, &schedule_, &graph_, 2, k_width, k_height};
        settings.loose_tiles = k_tile_limit;
        auto made = interface->create(settings);
        ASSERT_TRUE(made) << to_string(made.error());
        vegetation_ = std::move(*made);
    }

    Status add_loose(size_t t, uint64_t name) {
        const SceneTile& tile = scene_.tiles[t];
        auto of = [&](const auto& all) { return std::span(all).subspan(tile.first_plant, tile.plant_count); };
        return vegetation_->set_loose_tile(
            name, {tile.tile, of(scene_.positions), of(scene_.turns), of(scene_.plant_models)});
    }

    size_t differing(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
        size_t count = 0;
        for (size_t i = 0; i < a.size(); i += 4) count += !std::equal(&a[i], &a[i] + 4, &b[i]);
        return count;
    }

    // Of red, green and blue.
    static double mean(const std::vector<uint8_t>& rgba) {
        double sum = 0.0;
        for (size_t i = 0; i < rgba.size(); ++i) sum += i % 4 < 3 ? double(rgba[i]) : 0.0;
        return sum / (0.75 * double(rgba.size()));
    }

    std::vector<uint8_t> draw(bool level_of_detail, ShadowKind shadows = ShadowKind::none) {
        FrameSettings settings;
        settings.level_of_detail = level_of_detail;
        settings.shadows = shadows;
        return draw(settings);
    }
    std::vector<uint8_t> draw(const FrameSettings& settings) {
        do {
            auto frame = ring_.begin();
            EXPECT_TRUE(frame);
            vegetation_->set_slot(frame->slot);
            vegetation_->set_camera({});
            vegetation_->set_settings(settings);
            schedule_.run();
            graph_.record(frame->commands, frame->timestamps);
            EXPECT_TRUE(ring_.submit());
            EXPECT_TRUE(ring_.wait(frame->serial));
        } while (vegetation_->report().dropped_entries > 0);
        std::vector<uint8_t> rgba(size_t(k_width) * k_height * 4);
        EXPECT_TRUE(
            gpu::read_now(*device_, vegetation_->color(), 0, std::as_writable_bytes(std::span(rgba))));
        return rgba;
    }

    // The mean of so many frames, when it does not change any more.
    std::vector<uint8_t> settle(uint32_t accumulate_limit) {
        FrameSettings settings;
        settings.shadows = ShadowKind::clipmap;
        settings.accumulate_limit = accumulate_limit;
        std::vector<uint8_t> rgba = draw(settings);
        for (int i = 0; i < 200 && vegetation_->report().rested_frames < accumulate_limit; ++i)
            rgba = draw(settings);
        EXPECT_EQ(vegetation_->report().rested_frames, accumulate_limit);
        return rgba;
    }

    Registry registry_;
    std::vector<Plant> plants_;
    Scene scene_, empty_;
    std::unique_ptr<gpu::Device> device_;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;
    std::unique_ptr<Vegetation> vegetation_;
    gpu::CommandRing ring_;
};

TEST_F(LooseTiles, LookAsTheSceneDoes) {
    ASSERT_TRUE(vegetation_->set_scene(scene_, plants_));
    const std::vector<uint8_t> as_scene = draw(false);
    ASSERT_TRUE(vegetation_->set_scene(empty_, plants_));
    const std::vector<uint8_t> of_nothing = draw(false);
    EXPECT_GT(differing(of_nothing, as_scene), 50 * k_tie_limit);
    for (size_t t = 0; t < scene_.tiles.size(); ++t) ASSERT_TRUE(add_loose(t, 1000 + t));
    EXPECT_LE(differing(draw(false), as_scene), k_tie_limit);
    EXPECT_EQ(vegetation_->report().plants, 2600u);

    // Half of them the scene's.
    Scene half = scene_;
    const size_t kept = scene_.tiles.size() / 2;
    half.tiles.resize(kept);
    ASSERT_TRUE(vegetation_->set_scene(half, plants_));
    EXPECT_GT(differing(draw(false), as_scene), 50 * k_tie_limit);
    for (size_t t = kept; t < scene_.tiles.size(); ++t) ASSERT_TRUE(add_loose(t, t));
    EXPECT_LE(differing(draw(false), as_scene), k_tie_limit);

    // Changed, and taken away again: what is not hidden by others.
    size_t fullest = kept;
    for (size_t t = kept; t < scene_.tiles.size(); ++t)
        if (scene_.tiles[t].plant_count > scene_.tiles[fullest].plant_count) fullest = t;
    ASSERT_TRUE(vegetation_->set_loose_tile(fullest, {}));
    const std::vector<uint8_t> without = draw(false);
    EXPECT_GT(differing(without, as_scene), 50 * k_tie_limit);
    ASSERT_TRUE(add_loose(fullest, fullest));
    EXPECT_LE(differing(draw(false), as_scene), k_tie_limit);
    for (size_t t = kept; t < scene_.tiles.size(); ++t) ASSERT_TRUE(vegetation_->set_loose_tile(t, {}));
    ASSERT_TRUE(vegetation_->set_scene(empty_, plants_));
    EXPECT_LE(differing(draw(false), of_nothing), k_tie_limit);
}

// Shadows that stay are made again, map by map.
TEST_F(LooseTiles, ThrowTheShadowsOfTheScene) {
    auto drawn_for_long = [&] {
        for (uint32_t i = 0; i < k_shadow_map_places; ++i) draw(true, ShadowKind::clipmap);
        return mean(draw(true, ShadowKind::clipmap));
    };
    ASSERT_TRUE(vegetation_->set_scene(scene_, plants_));
    const double unshadowed = mean(draw(true)), as_scene = drawn_for_long();
    EXPECT_LT(as_scene, 0.99 * unshadowed);
    ASSERT_TRUE(vegetation_->set_scene(empty_, plants_));
    const double of_nothing = drawn_for_long();
    for (size_t t = 0; t < scene_.tiles.size(); ++t) ASSERT_TRUE(add_loose(t, t));
    // What was empty has no depths for them: all at once.
    EXPECT_NEAR(mean(draw(true, ShadowKind::clipmap)), as_scene, 0.002 * as_scene);
    for (size_t t = 1; t < scene_.tiles.size(); t += 2) ASSERT_TRUE(vegetation_->set_loose_tile(t, {}));
    const double of_half = drawn_for_long();
    EXPECT_GT(std::fabs(of_half - as_scene), 0.01 * as_scene);
    for (size_t t = 1; t < scene_.tiles.size(); t += 2) ASSERT_TRUE(add_loose(t, t));
    EXPECT_NEAR(drawn_for_long(), as_scene, 0.002 * as_scene);
    for (size_t t = 0; t < scene_.tiles.size(); ++t) ASSERT_TRUE(vegetation_->set_loose_tile(t, {}));
    EXPECT_EQ(drawn_for_long(), of_nothing);
}

// Levels of detail are each plant's own, so that few pixels change where no cloud stands for a tile.
// The mean of a view at rest is of one world: maps that are made again one by one must not leave what they were in it, however
// few frames it is of.
TEST_F(LooseTiles, LeaveNoShadowInAViewAtRest) {
    ASSERT_TRUE(vegetation_->set_scene(scene_, plants_));
    // A fern of 50 m between sun and scene, that the viewer does not see.
    const dvec3 above = dvec3(glm::normalize(Light{}.direction_to_sun)) * 150.0 - dvec3(0.0, 0.0, 15.0);
    const PlantPosition position{0.0f, 0.0f, 0.0f, 200.0f};
    const PlantTurn turn = pack_turn_about_y(0.0f);
    const PlantModel model{0, 1};
    const Box bounds{200.0f * plants_[0].bounds_plant.min, 200.0f * plants_[0].bounds_plant.max};
    const LooseTile shade{{above, bounds, 1}, {&position, 1}, {&turn, 1}, {&model, 1}};
    auto distance = [](const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
        double sum = 0.0;
        for (size_t i = 0; i < a.size(); ++i) sum += std::abs(int(a[i]) - int(b[i]));
        return sum / (0.75 * double(a.size()));
    };
    for (uint32_t frames : {1u, 4u, 24u}) {
        SCOPED_TRACE(frames);
        const std::vector<uint8_t> lit = settle(frames);
        EXPECT_LT(distance(settle(frames), lit), 1e-9);
        ASSERT_TRUE(vegetation_->set_loose_tile(1, shade));
        const double shaded = distance(settle(frames), lit);
        EXPECT_GT(shaded, 3.0);
        ASSERT_TRUE(vegetation_->set_loose_tile(1, {}));
        // Which frames the mean is of differs, where maps were made in some.
        EXPECT_LT(distance(settle(frames), lit), 0.05 * shaded);
    }
}

TEST_F(LooseTiles, HaveLevelsOfDetail) {
    ASSERT_TRUE(vegetation_->set_scene(empty_, plants_));
    for (size_t t = 0; t < scene_.tiles.size(); ++t) ASSERT_TRUE(add_loose(t, t));
    draw(false);
    const uint64_t full_triangles = vegetation_->report().triangles;
    draw(true);
    EXPECT_LT(vegetation_->report().vertices * 4, full_triangles * 3);
    EXPECT_GT(vegetation_->report().points, 0u);
}

TEST_F(LooseTiles, AreRefusedWhereTheyMakeNoSense) {
    ASSERT_TRUE(vegetation_->set_scene(empty_, plants_));
    ASSERT_TRUE(add_loose(0, 0));
    const std::vector<uint8_t> before = draw(false);
    const PlantPosition position{};
    const PlantTurn turn = pack_turn_about_y(0.0f);
    const PlantModel model{2, 0};
    const Status of_no_model = vegetation_->set_loose_tile(0, {{}, {&position, 1}, {&turn, 1}, {&model, 1}});
    ASSERT_FALSE(of_no_model);
    EXPECT_EQ(of_no_model.error().id, ErrorId::value_out_of_range);
    EXPECT_FALSE(vegetation_->set_loose_tile(0, {{}, {&position, 1}, {}, {&model, 1}}));
    for (uint32_t i = 1; i < k_tile_limit; ++i) ASSERT_TRUE(add_loose(0, i));
    const Status one_more = add_loose(0, k_tile_limit);
    ASSERT_FALSE(one_more);
    EXPECT_EQ(one_more.error().id, ErrorId::limit_exceeded);
    ASSERT_TRUE(vegetation_->set_loose_tile(3, {}));
    EXPECT_TRUE(add_loose(0, k_tile_limit));
    EXPECT_LE(differing(draw(false), before), k_tie_limit);
}

}  // namespace
}  // namespace coppice
