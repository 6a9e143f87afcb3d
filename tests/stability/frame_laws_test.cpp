// What a picture owes to no accident: where in the world it is, how large its plants are, how large it is itself, how near
// plants come, and how many there are.
#include "plugins/vegetation/cook/cook_plant.h"
#include "runtime/core/random.h"
#include "tests/cook/shapes.h"
#include "tests/stability/drawn_scene.h"

namespace coppice {
namespace {

constexpr PlantTurn k_upright{0, 0, 0, 32767};
constexpr ShadowKind k_every_kind[] = {ShadowKind::none, ShadowKind::uniform, ShadowKind::perspective,
                                       ShadowKind::light_space, ShadowKind::clipmap};

FrameSettings with_shadows(ShadowKind kind) {
    FrameSettings settings;
    settings.shadows = kind;
    return settings;
}

Plant cook(const PlantDescription& description) {
    auto bytes = cook_plant(description, {});
    EXPECT_TRUE(bytes) << to_string(bytes.error());
    if (!bytes) return {};
    auto plant =
        load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(*bytes)), description.name);
    EXPECT_TRUE(plant) << to_string(plant.error());
    return plant ? *plant : Plant{};
}

// 2 m: a stem, branches that become lines, and leaves.
Plant bush() {
    PlantDescription bush;
    bush.name = "bush";
    PartDescription wood;
    wood.name = "wood";
    shapes::add_tube(wood, shapes::straight_path(vec3(0), vec3(0, 1.9f, 0), 8),
                     {0.06f, 0.05f, 0.045f, 0.04f, 0.03f, 0.02f, 0.015f, 0.01f});
    for (int i = 0; i < 40; ++i) {
        const float around = float(i) * 2.4f, y = 0.6f + 0.03f * float(i);
        const vec3 from(0, y, 0),
            to = from + vec3(0.6f * portable_sin(around), 0.25f, 0.6f * portable_cos(around));
        shapes::add_tube(wood, shapes::straight_path(from, to, 4), {0.012f, 0.01f, 0.008f, 0.004f}, 6);
    }
    bush.parts.push_back(std::move(wood));
    bush.parts.push_back(shapes::leaf_cloud(800, 0.75f, 0.08f, 5, vec3(0, 1.2f, 0)));
    return cook(bush);
}

// 30 cm of blades.
Plant tuft() {
    PlantDescription tuft;
    tuft.name = "tuft";
    tuft.parts.emplace_back();
    tuft.parts[0].leaf = true;
    for (int i = 0; i < 60; ++i) {
        const float around = float(i) * 2.4f, out = 0.01f + 0.002f * float(i);
        const vec3 along(portable_sin(around), 0, portable_cos(around)), side(along.z, 0, -along.x);
        shapes::add_quad(tuft.parts[0], along * out - side * 0.004f, side * 0.008f,
                         along * out + vec3(0, 0.3f, 0));
    }
    return cook(tuft);
}

// Upright, 1 m wide and high, facing +z.
Plant one_triangle() {
    PlantDescription one;
    one.name = "one";
    one.parts.emplace_back();
    shapes::add_triangle(one.parts[0], vec3(-0.5f, 0, 0), vec3(0.5f, 0, 0), vec3(0, 1, 0));
    return cook(one);
}

class FrameLaws : public ::testing::Test {
  protected:
    static constexpr uint32_t k_width = 320, k_height = 200;
    static void SetUpTestSuite() {
        auto drawn = DrawnScene::create(k_width, k_height);
        ASSERT_TRUE(drawn) << to_string(drawn.error());
        drawn_ = std::move(*drawn);
        plants_ = {bush(), tuft()};
    }
    static void TearDownTestSuite() {
        drawn_.reset();
        plants_.clear();
    }
    void SetUp() override { ASSERT_TRUE(drawn_); }
    void TearDown() override {
        if (drawn_) {
            EXPECT_EQ(drawn_->validation_messages(), 0u);
        }
    }

    static void set(std::span<const Placement> placements, const std::vector<Plant>& plants) {
        const Status status = drawn_->set(placements, plants);
        ASSERT_TRUE(status) << to_string(status.error());
    }
    static PictureCounts draw(const Camera& camera, const FrameSettings& settings) {
        const Status status = drawn_->draw(camera, settings);
        EXPECT_TRUE(status) << to_string(status.error());
        const PictureCounts counts = drawn_->count();
        EXPECT_EQ(counts.wrong_depths, 0u);
        return counts;
    }
    // Looks along -z at the middle of what is height_m high at the foot, that many heights before it.
    static Camera camera_before(dvec3 foot, float height_m, float heights_away) {
        Camera camera;
        camera.vertical_fov_rad = 0.8f;
        camera.position_world =
            foot + dvec3(0.0, 0.5 * double(height_m), double(heights_away) * double(height_m));
        camera.near_m = 0.01f * height_m;
        return camera;
    }
    // 60 m of a slope.
    static std::vector<Placement> wood(dvec3 offset) {
        Random random(11);
        std::vector<Placement> placements;
        for (uint32_t i = 0; i < 700; ++i) {
            const float x = random.next_in(-30.0f, 30.0f), z = random.next_in(-60.0f, 0.0f);
            const float scale = random.next_in(0.6f, 1.5f), turn = random.next_in(0.0f, 6.28f);
            placements.push_back({offset + dvec3(x, 0.1f * x, z),
                                  scale,
                                  pack_turn_about_y(turn),
                                  {i % 2, uint32_t(random.next_bits())}});
        }
        return placements;
    }
    static Camera wood_camera(dvec3 offset) {
        Camera camera;
        camera.position_world = offset + dvec3(0.25, 2.5, 4.0);
        camera.pitch_rad = -0.1f;
        return camera;
    }

    static inline std::unique_ptr<DrawnScene> drawn_;
    static inline std::vector<Plant> plants_;  // a bush, a tuft
};

// Tiles have their origins on sixteenths of metres, and all that is drawn is relative to the viewer.
TEST_F(FrameLaws, ByWholeKilometresAwayEveryBitIsTheSame) {
    for (ShadowKind kind : {ShadowKind::none, ShadowKind::light_space, ShadowKind::clipmap}) {
        set(wood(dvec3(0.0)), plants_);
        EXPECT_GT(draw(wood_camera(dvec3(0.0)), with_shadows(kind)).covered_share(), 0.1);
        const std::vector<uint32_t> colors = drawn_->colors;
        const std::vector<uint64_t> words = drawn_->words;
        for (double away_m : {1024.0, 1024.0 * 97, 1024.0 * 976, 1024.0 * 9765}) {
            SCOPED_TRACE(testing::Message() << away_m << " m");
            const dvec3 offset(away_m, -0.125 * away_m, -away_m);
            set(wood(offset), plants_);
            draw(wood_camera(offset), with_shadows(kind));
            EXPECT_TRUE(words == drawn_->words);
            EXPECT_TRUE(colors == drawn_->colors);
        }
    }
}

// Then origins are rounded otherwise, and places by a few micrometres: borders of leaves fall into other pixels, and the texels of
// maps that stay, which are counted from the scene's origin, lie elsewhere by parts of a texel.
TEST_F(FrameLaws, AnywhereElseThePictureIsNearlyTheSame) {
    for (ShadowKind kind : {ShadowKind::none, ShadowKind::light_space, ShadowKind::clipmap}) {
        const double most_other_color = kind == ShadowKind::clipmap ? 0.0015 : 0.0005;
        set(wood(dvec3(0.0)), plants_);
        const PictureCounts here = draw(wood_camera(dvec3(0.0)), with_shadows(kind));
        const std::vector<uint64_t> words = drawn_->words;
        for (double away_m : {0.3, 1e3 + 0.3, 1e5 + 0.3, 1e7 + 0.3}) {
            SCOPED_TRACE(testing::Message() << away_m << " m, shadows " << int(kind));
            const dvec3 offset(away_m, -0.7 * away_m, -1.1 * away_m);
            set(wood(offset), plants_);
            const PictureCounts there = draw(wood_camera(offset), with_shadows(kind));
            EXPECT_NEAR(there.covered_share(), here.covered_share(), 0.002 * here.covered_share());
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(there.shown_color[c], here.shown_color[c], most_other_color);
            size_t other = 0;
            for (size_t i = 0; i < words.size(); ++i) other += (words[i] == 0) != (drawn_->words[i] == 0);
            // A pixel in a thousand, where there are as many borders as pixels.
            EXPECT_LT(other, words.size() / 1000);
        }
    }
}

TEST_F(FrameLaws, OfAnyScaleThePictureIsTheSame) {
    for (uint32_t model : {0u, 1u})
        for (float heights : {0.8f, 3.0f, 40.0f})
            for (ShadowKind kind : {ShadowKind::none, ShadowKind::light_space, ShadowKind::clipmap}) {
                PictureCounts natural;
                for (float scale : {1.0f, 1e-4f, 1e-3f, 0.01f, 0.1f, 10.0f, 100.0f, 1e3f, 1e4f}) {
                    SCOPED_TRACE(testing::Message()
                                 << "plant " << model << ", " << heights << " heights away, scale " << scale
                                 << ", shadows " << int(kind));
                    const float height_m = scale * plants_[model].bounds_plant.max.y;
                    std::vector<Placement> three;
                    for (int x = -1; x <= 1; ++x)
                        three.push_back({dvec3(double(x) * double(height_m), 0.0, 0.0),
                                         scale,
                                         pack_turn_about_y(float(x)),
                                         {model, 77u + uint32_t(x)}});
                    set(three, plants_);
                    FrameSettings settings = with_shadows(kind);
                    settings.shadow_distance_m = 100.0f * height_m;
                    const PictureCounts counts = draw(camera_before(dvec3(0.0), height_m, heights), settings);
                    if (scale == 1.0f) natural = counts;
                    EXPECT_GT(counts.covered, 0u);
                    EXPECT_NEAR(double(counts.covered), double(natural.covered),
                                0.005 * double(natural.covered) + 2.0);
                    // Nested maps' texels are of sizes by powers of two, of plants of other scales finer or coarser. Those of two
                    // metres and more, of plants of that size, tell shadow from light no more (draw/sunlit.glsl).
                    const double most_other = kind == ShadowKind::clipmap ? 0.007 : 0.001;
                    const double most_darker = kind != ShadowKind::none && scale > 1.0f ? 0.07 : most_other;
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_LT(counts.shown_color[c], natural.shown_color[c] + most_other);
                        EXPECT_GT(counts.shown_color[c], natural.shown_color[c] - most_darker);
                    }
                }
            }
}

// A triangle's pixels are those whose centres it covers, from one pixel to the most the device takes.
TEST_F(FrameLaws, OfAnyPictureSizeATriangleCoversWhatItCovers) {
    const std::vector<Plant> plants{one_triangle()};
    const Placement at_origin{dvec3(0.0), 1.0f, k_upright, {0, 5}};
    struct Size {
        uint32_t width, height;
    };
    const Size sizes[] = {{1, 1},     {2, 1},    {1, 2},    {3, 5},      {17, 1},
                          {641, 359}, {1, 8192}, {8192, 1}, {7680, 4320}};
    for (const Size size : sizes) {
        SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
        const bool fits =
            uint64_t(size.width) * size.height * 8 <= drawn_->device().limits.storage_range_bytes;
        const Status resized = drawn_->resize(size.width, size.height);
        EXPECT_EQ(bool(resized), fits);
        if (!resized) {
            EXPECT_EQ(resized.error().id, ErrorId::limit_exceeded);
            continue;
        }
        set(std::span(&at_origin, 1), plants);
        for (float metres_away : {0.5f, 1.7f}) {
            FrameSettings settings;
            settings.level_of_detail = false;
            const Camera camera = camera_before(dvec3(0.0), 1.0f, metres_away);
            draw(camera, settings);
            const double focal_px = 0.5 * size.height / std::tan(0.5 * double(camera.vertical_fov_rad));
            const double a_pixel = double(metres_away) / focal_px, edge = 1e-5 + 1e-4 * a_pixel;
            size_t wrong = 0;
            for (uint32_t row = 0; row < size.height; ++row)
                for (uint32_t column = 0; column < size.width; ++column) {
                    const double x = (column + 0.5 - 0.5 * size.width) * a_pixel;
                    const double y = 0.5 - (row + 0.5 - 0.5 * size.height) * a_pixel;
                    // How far inside; at the edge either is right.
                    const double inside = std::min(y, 0.5 * (1.0 - y) - std::fabs(x));
                    const bool covered = drawn_->words[size_t(row) * size.width + column] != 0;
                    wrong += std::fabs(inside) > edge && covered != (inside > 0.0);
                }
            EXPECT_EQ(wrong, 0u) << metres_away << " m away";
        }
    }
    ASSERT_TRUE(drawn_->resize(k_width, k_height));
}

TEST_F(FrameLaws, OfAnyPictureSizeAsMuchIsCovered) {
    set(wood(dvec3(0.0)), plants_);
    struct Size {
        uint32_t width, height;
    };
    for (ShadowKind kind : {ShadowKind::none, ShadowKind::light_space, ShadowKind::clipmap}) {
        PictureCounts first;
        for (const Size size : {Size{640, 400}, Size{320, 200}, Size{1280, 800}, Size{2560, 1600}}) {
            SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
            ASSERT_TRUE(drawn_->resize(size.width, size.height));
            const PictureCounts counts = draw(wood_camera(dvec3(0.0)), with_shadows(kind));
            if (first.pixels == 0) first = counts;
            EXPECT_NEAR(counts.covered_share(), first.covered_share(), 0.01 * first.covered_share());
        }
        // Too few pixels for shares: drawn, and all numbers.
        for (const Size size :
             {Size{1, 1}, Size{2, 1}, Size{1, 2}, Size{3, 5}, Size{1, 8192}, Size{8192, 1}}) {
            SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
            ASSERT_TRUE(drawn_->resize(size.width, size.height));
            draw(wood_camera(dvec3(0.0)), with_shadows(kind));
        }
    }
    ASSERT_TRUE(drawn_->resize(k_width, k_height));
}

TEST_F(FrameLaws, NoPlantsShowTheSky) {
    for (ShadowKind kind : k_every_kind)
        for (const std::vector<Plant>& plants : {plants_, std::vector<Plant>{}}) {
            set({}, plants);
            const PictureCounts counts = draw(wood_camera(dvec3(0.0)), with_shadows(kind));
            EXPECT_EQ(counts.covered, 0u);
            EXPECT_GT(counts.shown_color.z, 0.5);
        }
}

// From many pixels each to less than one.
TEST_F(FrameLaws, SingleTrianglesCoverTheirArea) {
    std::vector<Placement> grid;
    for (uint32_t i = 0; i < 400; ++i)
        grid.push_back({dvec3(2.0 * (double(i % 20) - 9.5), 2.0 * (double(i / 20) - 9.5), 0.0),
                        1.0f,
                        k_upright,
                        {0, i * 0x9e3779b9u}});
    const std::vector<Plant> plants{one_triangle()};
    set(grid, plants);
    for (ShadowKind kind : k_every_kind)
        for (float metres_away : {60.0f, 120.0f, 300.0f}) {
            SCOPED_TRACE(testing::Message() << metres_away << " m, shadows " << int(kind));
            Camera camera;
            camera.vertical_fov_rad = 0.8f;
            camera.position_world = dvec3(0.0, 0.5, double(metres_away));
            const double pixels_a_metre = 0.5 * k_height / std::tan(0.4) / double(metres_away);
            const double expected = 400.0 * 0.5 * pixels_a_metre * pixels_a_metre;
            const double covered = double(draw(camera, with_shadows(kind)).covered);
            EXPECT_NEAR(covered, expected, 0.05 * expected);
        }
}

TEST_F(FrameLaws, ThousandsAtOneSpotLookLikeOne) {
    const dvec3 spot(3.0, 1.0, -2.0);
    for (uint32_t model : {0u, 1u}) {
        const std::vector<Placement> pile(2500, Placement{spot, 1.0f, k_upright, {model, 9}});
        const Camera camera = camera_before(spot, plants_[model].bounds_plant.max.y, 6.0f);
        for (ShadowKind kind : {ShadowKind::none, ShadowKind::light_space, ShadowKind::clipmap}) {
            SCOPED_TRACE(testing::Message() << "plant " << model << ", shadows " << int(kind));
            set(std::span(pile).first(1), plants_);
            const PictureCounts alone = draw(camera, with_shadows(kind));
            set(pile, plants_);
            const PictureCounts all = draw(camera, with_shadows(kind));
            EXPECT_GT(alone.covered, 100u);
            EXPECT_EQ(drawn_->report().plants_visible, 2500u);
            EXPECT_NEAR(double(all.covered), double(alone.covered), 0.02 * double(alone.covered));
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(all.shown_color[c], alone.shown_color[c], 0.002);
        }
    }
}

// Plants that begin behind the near plane, on it and before it, on all sides; and one that the viewer is in the middle of.
// What levels of detail show is as much as all triangles do.
TEST_F(FrameLaws, AtTheNearPlaneAndAroundTheViewerAsMuchIsCovered) {
    for (uint32_t model : {0u, 1u})
        for (float ring_m : {0.0f, 0.1f, 0.3f, 1.5f}) {
            const float height_m = plants_[model].bounds_plant.max.y;
            std::vector<Placement> ring;
            for (int i = 0; i < (ring_m > 0.0f ? 24 : 1); ++i) {
                const float turn = float(i) * (2.0f * k_pi / 24.0f);
                ring.push_back({dvec3(double(ring_m * portable_sin(turn)), -0.5 * double(height_m),
                                      double(ring_m * portable_cos(turn))),
                                1.0f,
                                pack_turn_about_y(turn),
                                {model, uint32_t(i)}});
            }
            set(ring, plants_);
            for (float near_m : {0.01f, 0.1f})
                for (float yaw : {0.0f, 2.0f})
                    for (float pitch : {-1.5707963f, 0.0f}) {
                        SCOPED_TRACE(testing::Message()
                                     << "plant " << model << ", ring " << ring_m << " m, near " << near_m
                                     << ", yaw " << yaw << ", pitch " << pitch);
                        Camera camera;
                        camera.position_world = dvec3(0.0);
                        camera.near_m = near_m;
                        camera.yaw_rad = yaw;
                        camera.pitch_rad = pitch;
                        FrameSettings every_triangle = with_shadows(ShadowKind::none);
                        every_triangle.level_of_detail = false;
                        const double truth = draw(camera, every_triangle).covered_share();
                        const double lod = draw(camera, {}).covered_share();
                        EXPECT_NEAR(lod, truth, 0.01);
                    }
        }
}

}  // namespace
}  // namespace coppice
