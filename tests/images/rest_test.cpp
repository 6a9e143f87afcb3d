// A view at rest over tiles that their clouds stand for: the mean must not lose what a single frame covers.
#include <cmath>
#include "tests/images/hills.h"

namespace coppice {
namespace {

constexpr uint32_t k_rest_frames = 24;

// Share of the picture that plants cover, of a picture of RepresentationView::coverage: sRGB-encoded 0 to 1.
double covered(const std::vector<uint32_t>& colors) {
    double sum = 0.0;
    for (uint32_t color : colors) {
        const double coded = double(color & 255u) / 255.0;
        sum += coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
    }
    return sum / double(colors.size());
}

TEST(Rest, FarTilesCoverWhatTheyDoInMotion) {
    auto hills = Hills::create({});
    ASSERT_TRUE(hills) << to_string(hills.error());
    const Camera camera = (*hills)->camera_at(0.0f, 0.0f, 900.0f, 1.0f, -1.3f);
    FrameSettings settings;
    settings.view = RepresentationView::coverage;
    settings.sample_distance_px = 1.0f;
    settings.accumulate_limit = k_rest_frames;
    double in_motion = 0.0;
    uint32_t with_clouds = 0;
    for (uint32_t frame = 0; frame <= k_rest_frames; ++frame) {
        ASSERT_TRUE((*hills)->draw(camera, settings));
        const FrameReport& report = (*hills)->vegetation->report();
        if (frame < k_rest_frames) {
            EXPECT_EQ(report.rested_frames, frame);
        }
        with_clouds += report.clouds > 0 && report.cloud_plants > report.plants / 2;
        auto colors = (*hills)->read<uint32_t>((*hills)->vegetation->color());
        ASSERT_TRUE(colors);
        const double share = covered(*colors);
        if (frame == 0) {
            in_motion = share;
            EXPECT_GT(in_motion, 0.005);
        }
        // d' falls from 1 to a quarter, which single frames that far away differ by 9 % for.
        EXPECT_NEAR(share, in_motion, 0.12 * in_motion) << "frame " << frame;
    }
    EXPECT_GT(with_clouds, k_rest_frames / 2) << "hardly a cloud: the test says nothing";
}

}  // namespace
}  // namespace coppice
