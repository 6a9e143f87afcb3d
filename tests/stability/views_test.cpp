// Views that no one would choose: whatever the camera does, the frame is drawn, its depths are numbers between the near
// plane and infinity, and the validation layer has nothing to say.
#include <bit>
#include "tests/images/hills.h"

namespace coppice {
namespace {

class Views : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        HillsSettings settings;
        settings.birches = 30;
        settings.shrubs = 60;
        settings.grasses = 200;
        settings.validation = true;
        auto hills = Hills::create(settings);
        ASSERT_TRUE(hills) << to_string(hills.error());
        hills_ = std::move(*hills);
    }
    static void TearDownTestSuite() { hills_.reset(); }
    void SetUp() override { ASSERT_TRUE(hills_); }
    void TearDown() override {
        if (hills_) {
            EXPECT_EQ(hills_->validation_messages(), 0u);
        }
    }

    // Pixels that show something.
    size_t draw(const Camera& camera, const FrameSettings& settings) {
        const Status status = hills_->draw(camera, settings);
        EXPECT_TRUE(status);
        if (!status) return 0;
        const auto words = hills_->read<uint64_t>(hills_->vegetation->visibility());
        EXPECT_TRUE(words);
        size_t covered = 0, wrong = 0;
        for (uint64_t word : *words) {
            if (word == 0) continue;
            ++covered;
            const float depth = std::bit_cast<float>(uint32_t(word >> 32));
            wrong += !(depth >= 0.0f && depth <= 1.0f);  // also what is not a number
        }
        EXPECT_EQ(wrong, 0u);
        return covered;
    }

    static inline std::unique_ptr<Hills> hills_;
};

TEST_F(Views, OfEveryAngleAndNearPlaneAreDrawn) {
    for (float degrees : {1.0f, 10.0f, 60.0f, 120.0f, 170.0f})
        for (float near_m : {0.001f, 0.01f, 0.1f, 1.0f, 50.0f}) {
            SCOPED_TRACE(testing::Message() << degrees << " degrees, near " << near_m);
            Camera camera = hills_->camera_at(0.0f, 0.0f, 1.7f, 0.4f, -0.3f);
            camera.vertical_fov_rad = degrees * 3.14159265f / 180.0f;
            camera.near_m = near_m;
            const size_t covered = draw(camera, {});
            // Of a wide view's ground most lies below the viewer, nearer than a near plane of 1 m.
            if (near_m <= 0.1f) {
                EXPECT_GT(covered, size_t(Hills::k_width * Hills::k_height) / 3);
            }
        }
}

TEST_F(Views, OfEverySampleDistanceAreDrawn) {
    uint64_t vertices = UINT64_MAX;
    for (float sample_px : {0.01f, 0.1f, 1.0f, 10.0f, 1000.0f}) {
        SCOPED_TRACE(sample_px);
        FrameSettings settings;
        settings.sample_distance_px = sample_px;
        draw(hills_->camera_at(10.0f, -20.0f, 1.7f, 2.0f), settings);
        EXPECT_LE(hills_->vegetation->report().vertices, vertices);
        vertices = hills_->vegetation->report().vertices;
    }
}

// Straight up and down, under the ground, and as far away as a world is wide.
TEST_F(Views, FromAnywhereAreDrawn) {
    for (float pitch_rad : {-1.5707963f, 0.0f, 1.5707963f})
        for (float above_m : {-5.0f, 0.0f, 1e-4f, 0.3f, 1000.0f})
            draw(hills_->camera_at(3.0f, 4.0f, above_m, 1.0f, pitch_rad), {});
    for (double away_m : {1e4, 1e6, 1e7, 1e9}) {
        Camera camera = hills_->camera_at(0.0f, 0.0f, 60.0f, 0.0f);
        camera.position_world.z += away_m;
        draw(camera, {});
    }
}

}  // namespace
}  // namespace coppice
