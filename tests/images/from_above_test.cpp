// Plants that are a few pixels tall, or a fraction of one, and seen from high above: what their points and their tiles'
// clouds cover against what all their triangles cover.
#include <cmath>
#include "tests/images/hills.h"

namespace coppice {
namespace {

constexpr int k_frames = 48, k_full_frames = 12;

// Of pictures of RepresentationView::coverage: sRGB-encoded 0 to 1.
double covered(const std::vector<uint32_t>& colors) {
    double sum = 0.0;
    for (uint32_t color : colors) {
        const double coded = double(color & 255u) / 255.0;
        sum += coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
    }
    return sum;
}

class FromAbove : public ::testing::Test {
  protected:
    void SetUp() override {
        HillsSettings few;
        few.birches = 300;
        few.shrubs = 900;
        few.grasses = 3500;
        auto hills = Hills::create(few);
        ASSERT_TRUE(hills) << to_string(hills.error());
        hills_ = std::move(*hills);
    }
    // Pixels, in the mean over views that differ by turns about the vertical and little steps.
    double mean_covered(float above_m, float pitch_rad, int frames, const FrameSettings& settings) {
        double sum = 0.0;
        for (int i = 0; i < frames; ++i) {
            const float turn = 2.0f * k_pi * float(i) / float(frames);
            const float back_m = above_m * std::cos(-pitch_rad) / std::max(std::sin(-pitch_rad), 0.2f);
            EXPECT_TRUE(hills_->draw(
                hills_->camera_at(back_m * std::sin(turn), back_m * std::cos(turn), above_m, turn, pitch_rad),
                settings));
            cloud_plants_ += hills_->vegetation->report().cloud_plants;
            plants_ += hills_->vegetation->report().plants;
            auto colors = hills_->read<uint32_t>(hills_->vegetation->color());
            EXPECT_TRUE(colors);
            sum += covered(*colors) / frames;
        }
        return sum;
    }
    std::unique_ptr<Hills> hills_;
    uint64_t cloud_plants_ = 0, plants_ = 0;
};

// The same points in each view, so that it takes hundreds of them: at 900 m and d' = 2 px there are 140.
TEST_F(FromAbove, FarPlantsCoverWhatTheirTrianglesDo) {
    struct Case {
        float above_m, pitch_rad;
        double bound[2];  // at d' = 1 and 2
    };
    for (const Case& test : {Case{900.0f, -1.3f, {0.06, 0.12}}, Case{300.0f, -1.3f, {0.05, 0.06}},
                             Case{300.0f, -0.6f, {0.05, 0.06}}}) {
        FrameSettings settings;
        settings.view = RepresentationView::coverage;
        settings.level_of_detail = false;
        const double wanted = mean_covered(test.above_m, test.pitch_rad, k_full_frames, settings);
        settings.level_of_detail = true;
        for (int i = 0; i < 2; ++i) {
            settings.sample_distance_px = float(i + 1);
            cloud_plants_ = plants_ = 0;
            const double error =
                mean_covered(test.above_m, test.pitch_rad, k_frames, settings) / wanted - 1.0;
            std::printf("%.0f m, pitch %.1f, d' = %d: %+.1f %% of %.0f px, %.0f %% of the plants in clouds\n",
                        double(test.above_m), double(test.pitch_rad), i + 1, 100.0 * error, wanted,
                        100.0 * double(cloud_plants_) / double(plants_));
            EXPECT_GT(cloud_plants_, plants_ / 2);
            EXPECT_LE(std::fabs(error), test.bound[i]);
        }
    }
}

}  // namespace
}  // namespace coppice
