// The vertex budget as a user meets it: what a frame draws, also in the frame of a camera cut.
#include "tests/images/hills.h"

namespace coppice {
namespace {

// As asked for.
constexpr double k_tolerance = 0.02;

class Budget : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        auto hills = Hills::create({});
        ASSERT_TRUE(hills) << to_string(hills.error());
        hills_ = std::move(*hills);
    }
    static void TearDownTestSuite() { hills_.reset(); }
    void SetUp() override { ASSERT_TRUE(hills_); }

    // Six flights, five cuts between them: over the meadow, along the slopes, from high above.
    static Camera camera_of(uint32_t frame) {
        constexpr uint32_t k_shot_frames = 15;
        struct Shot {
            float x, z, above_m, yaw_rad, pitch_rad;
        };
        constexpr Shot k_shots[] = {
            {0.0f, 0.0f, 1.7f, 0.0f, 0.0f},        {-200.0f, 150.0f, 0.6f, 2.0f, -0.1f},
            {100.0f, -120.0f, 60.0f, 4.0f, -0.4f}, {-40.0f, 220.0f, 3.0f, 5.5f, 0.1f},
            {0.0f, 0.0f, 400.0f, 1.0f, -1.2f},     {210.0f, 30.0f, 1.2f, 3.0f, 0.0f}};
        const Shot& shot = k_shots[frame / k_shot_frames];
        const float on = float(frame % k_shot_frames);
        return hills_->camera_at(shot.x + 0.7f * on, shot.z - 0.4f * on, shot.above_m,
                                 shot.yaw_rad + 0.02f * on, shot.pitch_rad);
    }
    static constexpr uint32_t k_frames = 90;

    static inline std::unique_ptr<Hills> hills_;
};

TEST_F(Budget, IsDrawnInEveryFrameOfAPathWithFiveCuts) {
    uint32_t clouds = 0;
    for (uint64_t budget : {15'000u, 30'000u, 150'000u, 600'000u}) {
        FrameSettings settings;
        settings.sample_distance_px = 0.2f;
        settings.most_sample_distance_px = 100.0f;
        settings.vertex_budget = budget;
        double worst = 0.0;
        float least_px = 1e9f, most_px = 0.0f;
        for (uint32_t frame = 0; frame < k_frames; ++frame) {
            const FrameReport& report = hills_->plan(camera_of(frame), settings);
            const double off = double(report.vertices) / double(budget) - 1.0;
            EXPECT_LE(std::fabs(off), k_tolerance)
                << "frame " << frame << ", d' = " << report.sample_distance_px;
            EXPECT_EQ(report.vertex_budget, budget);
            worst = std::max(worst, std::fabs(off));
            least_px = std::min(least_px, report.sample_distance_px);
            most_px = std::max(most_px, report.sample_distance_px);
            clouds += report.clouds;
        }
        std::printf("%llu vertices: at worst %.2f %% off, d' from %.2f to %.2f px\n",
                    (unsigned long long)budget, 100.0 * worst, double(least_px), double(most_px));
        EXPECT_GT(most_px, 2.0f * least_px) << "the views are to differ";
    }
    EXPECT_GT(clouds, 0u);
}

TEST_F(Budget, AsksForNoMoreThanTheSettingsDo) {
    FrameSettings settings;
    settings.sample_distance_px = 1.5f;
    const uint64_t asked = hills_->plan(camera_of(0), settings).vertices;
    settings.vertex_budget = 10 * asked;
    const FrameReport& report = hills_->plan(camera_of(0), settings);
    EXPECT_EQ(report.sample_distance_px, 1.5f);
    EXPECT_EQ(report.vertices, asked);
}

TEST_F(Budget, LeavesTheMostSampleDistance) {
    FrameSettings settings;
    settings.vertex_budget = 1;
    const FrameReport& report = hills_->plan(camera_of(0), settings);
    EXPECT_EQ(report.sample_distance_px, settings.most_sample_distance_px);
    EXPECT_GT(report.vertices, 100u);
}

TEST_F(Budget, IsNoneWithoutLevelsOfDetail) {
    FrameSettings settings;
    settings.level_of_detail = false;
    const uint64_t all = hills_->plan(camera_of(20), settings).triangles;
    settings.vertex_budget = 1000;
    const FrameReport& report = hills_->plan(camera_of(20), settings);
    EXPECT_EQ(report.triangles, all);
    EXPECT_EQ(report.vertex_budget, 0u);
}

// A machine that takes so long a vertex, and a frame more.
TEST_F(Budget, OfTimeIsHeldOnceCostsAreLearned) {
    auto frame_ms = [](const FrameReport& report) {
        return 4.0 + 1e-6 * (60.0 * double(report.triangles) + 40.0 * double(report.lines) +
                             15.0 * double(report.points));
    };
    FrameSettings settings;
    settings.sample_distance_px = 0.2f;
    settings.most_sample_distance_px = 100.0f;
    settings.time_budget_ms = 10.0f;
    double worst = 0.0;
    for (int round = 0; round < 2; ++round)
        for (uint32_t frame = 0; frame < k_frames; ++frame) {
            const double ms = frame_ms(hills_->plan(camera_of(frame), settings));
            hills_->vegetation->set_frame_ms(0, ms);
            if (round == 1) worst = std::max(worst, std::fabs(ms / double(settings.time_budget_ms) - 1.0));
        }
    std::printf("once learned, at worst %.1f %% off\n", 100.0 * worst);
    EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace coppice
