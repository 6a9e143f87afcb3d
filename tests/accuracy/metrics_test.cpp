// Errors of pictures whose answers are known by hand. The images module does the comparing, as in the bench.
#include "tools/accuracy/metrics.h"
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <limits>
#include "plugins/vegetation/components.h"
#include "runtime/core/math.h"
#include "runtime/plugin/registry.h"

namespace coppice {
namespace {

MeasuredFrame flat(uint32_t width, uint32_t height, vec3 color, float coverage) {
    MeasuredFrame frame{{width, height, {}}, std::vector<float>(size_t(width) * height, coverage)};
    for (size_t i = 0; i < frame.coverage.size(); ++i)
        for (int c = 0; c < 3; ++c) frame.display.rgb.push_back(color[c]);
    return frame;
}

void set_pixel(MeasuredFrame& frame, uint32_t x, uint32_t y, vec3 color, float coverage) {
    const size_t i = size_t(y) * frame.display.width + x;
    for (int c = 0; c < 3; ++c) frame.display.rgb[i * 3 + size_t(c)] = color[c];
    frame.coverage[i] = coverage;
}

class Metrics : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        ::setenv("COPPICE_PLUGIN_PATH", IMAGES_MODULE_DIR, 1);
        registry_ = new Registry();
        auto loaded = registry_->load("images");
        ASSERT_TRUE(loaded) << to_string(loaded.error());
    }
    static void TearDownTestSuite() { delete registry_; }
    void SetUp() override {
        images_ = registry_->find<ImagesInterface>(k_images_interface, k_images_version);
        ASSERT_NE(images_, nullptr);
    }
    FrameErrors errors_of(const MeasuredFrame& frame, const MeasuredFrame& reference) {
        auto errors = measure_errors(frame, reference, *images_);
        EXPECT_TRUE(errors) << to_string(errors.error());
        return errors ? *errors : FrameErrors{NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    }

    static inline Registry* registry_ = nullptr;
    const ImagesInterface* images_ = nullptr;
};

TEST_F(Metrics, EqualFramesHaveNoError) {
    const MeasuredFrame frame = flat(33, 20, {0.2f, 0.4f, 0.1f}, 0.3f);
    const FrameErrors errors = errors_of(frame, frame);
    EXPECT_EQ(errors.rmse, 0.0);
    EXPECT_EQ(errors.psnr_db, INFINITY);
    EXPECT_EQ(errors.flip, 0.0);
    EXPECT_EQ(errors.coverage, 0.0);
    EXPECT_EQ(errors.coverage_bias, 0.0);
    EXPECT_EQ(errors.mean_color, 0.0);
    EXPECT_EQ(errors.mean_color_bias, 0.0);
}

TEST_F(Metrics, AFlatGreyDifferenceIsItsValueInAll) {
    const FrameErrors errors = errors_of(flat(37, 21, vec3(0.5f), 0.25f), flat(37, 21, vec3(0.75f), 0.75f));
    EXPECT_NEAR(errors.rmse, 0.25, 1e-9);
    EXPECT_NEAR(errors.psnr_db, 20 * std::log10(4.0), 1e-6);
    EXPECT_NEAR(errors.mean_color, 0.25, 1e-9);
    EXPECT_NEAR(errors.mean_color_bias, 0.25, 1e-9);
    EXPECT_NEAR(errors.coverage, 0.5, 1e-9);
    EXPECT_NEAR(errors.coverage_bias, -0.5, 1e-9);  // too thin
    EXPECT_GT(errors.flip, 0.05);
    EXPECT_LT(errors.flip, 0.95);
}

TEST_F(Metrics, FlipIsTheMeanOfItsMap) {
    // Half green for blue, seen so that the border's blur does not reach far.
    const MeasuredFrame blue = flat(200, 8, {0, 0, 1}, 0);
    MeasuredFrame half = blue;
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 100; ++x) set_pixel(half, x, y, {0, 1, 0}, 0);
    EXPECT_NEAR(errors_of(half, blue).flip, 0.5, 0.04);
}

TEST_F(Metrics, ColourCountsByItsLength) {
    // One channel of three by 0.6: rms and mean colour agree on a flat picture.
    const FrameErrors errors = errors_of(flat(16, 16, {0.6f, 0, 0}, 0), flat(16, 16, vec3(0), 0));
    EXPECT_NEAR(errors.mean_color, 0.6 / std::sqrt(3.0), 1e-7);
    EXPECT_NEAR(errors.mean_color_bias, errors.mean_color, 1e-12);
    EXPECT_NEAR(errors.rmse, errors.mean_color, 1e-7);
}

TEST_F(Metrics, NoiseOfPixelsAveragesOutInSquares) {
    // A checkerboard of 0 and 1 against its mean, in squares of even sides.
    MeasuredFrame board = flat(32, 32, vec3(0), 0);
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = y % 2; x < 32; x += 2) set_pixel(board, x, y, vec3(1), 1);
    const FrameErrors errors = errors_of(board, flat(32, 32, vec3(0.5f), 0.5f));
    EXPECT_NEAR(errors.rmse, 0.5, 1e-9);
    EXPECT_EQ(errors.coverage, 0.0);
    EXPECT_EQ(errors.mean_color, 0.0);
    EXPECT_EQ(errors.coverage_bias, 0.0);
    EXPECT_EQ(errors.mean_color_bias, 0.0);
}

TEST_F(Metrics, AMissingCrownAndOneTooManyCancelOnlyInTheBias) {
    // A plant of a square's size, in another square than the reference's.
    const MeasuredFrame empty = flat(48, 16, vec3(0), 0);
    MeasuredFrame left = empty, right = empty;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 16; ++x) {
            set_pixel(left, x, y, vec3(0.3f), 1);
            set_pixel(right, x + 32, y, vec3(0.3f), 1);
        }
    const FrameErrors errors = errors_of(left, right);
    EXPECT_NEAR(errors.coverage, 2.0 / 3, 1e-9);
    EXPECT_NEAR(errors.coverage_bias, 0.0, 1e-12);
    EXPECT_NEAR(errors.mean_color, 0.2, 1e-7);
    EXPECT_NEAR(errors.mean_color_bias, 0.0, 1e-9);
    EXPECT_NEAR(errors_of(left, empty).coverage_bias, 1.0 / 3, 1e-9);
}

TEST_F(Metrics, SquaresAtTheBorderWeighByTheirPixels) {
    // 20 x 18: the corner square has 4 x 2 pixels.
    const MeasuredFrame reference = flat(20, 18, vec3(0), 0);
    MeasuredFrame corner = reference;
    for (uint32_t y = 16; y < 18; ++y)
        for (uint32_t x = 16; x < 20; ++x) set_pixel(corner, x, y, vec3(1), 1);
    const FrameErrors errors = errors_of(corner, reference);
    EXPECT_NEAR(errors.coverage, 8.0 / 360, 1e-12);
    EXPECT_NEAR(errors.mean_color, 8.0 / 360, 1e-12);
    EXPECT_NEAR(errors.coverage_bias, 8.0 / 360, 1e-12);
}

TEST_F(Metrics, RefusesWhatIsNoPair) {
    const MeasuredFrame frame = flat(8, 6, vec3(0), 0);
    MeasuredFrame no_coverage = frame, not_finite = frame, lost = frame;
    no_coverage.coverage.pop_back();
    not_finite.display.rgb[17] = NAN;
    lost.coverage[3] = std::numeric_limits<float>::infinity();
    for (const MeasuredFrame& other :
         {flat(6, 8, vec3(0), 0), MeasuredFrame{}, no_coverage, not_finite, lost}) {
        for (auto errors : {measure_errors(frame, other, *images_), measure_errors(other, frame, *images_)}) {
            ASSERT_FALSE(errors);
            EXPECT_EQ(errors.error().id, ErrorId::value_out_of_range) << to_string(errors.error());
        }
    }
    EXPECT_FALSE(measure_errors({}, {}, *images_));
}

TEST_F(Metrics, AnOlderImagesModuleIsNamed) {
    ImagesInterface older = *images_;
    older.size_bytes = sizeof(ImagesInterface) - sizeof(void*);
    const MeasuredFrame frame = flat(4, 4, vec3(0), 0);
    auto errors = measure_errors(frame, frame, older);
    ASSERT_FALSE(errors);
    EXPECT_EQ(errors.error().id, ErrorId::name_unknown);
}

TEST(DisplayLight, FollowsTheToneCurve) {
    const FloatPicture radiance{3, 1, {0.0f, 0.1f, 1.0f, 0.5f, 2.0f, 20.0f, 1e30f, INFINITY, NAN}};
    const FloatPicture display = display_light(radiance, Light());
    EXPECT_EQ(display.width, 3u);
    EXPECT_EQ(display.height, 1u);
    ASSERT_EQ(display.rgb.size(), 9u);
    EXPECT_EQ(display.rgb[0], 0.0f);
    EXPECT_NEAR(display.rgb[1], 0.1 * 0.281 / (0.1 * 0.833 + 0.14), 1e-6);
    EXPECT_NEAR(display.rgb[2], 2.54 / 3.16, 1e-6);
    EXPECT_NEAR(display.rgb[3], 0.5 * 1.285 / (0.5 * 1.805 + 0.14), 1e-6);
    EXPECT_NEAR(display.rgb[4], 2 * 5.05 / (2 * 5.45 + 0.14), 1e-6);
    for (size_t i : {5, 6, 7}) EXPECT_EQ(display.rgb[i], 1.0f) << i;
    EXPECT_EQ(display.rgb[8], 0.0f);
}

TEST(DisplayLight, ExposureScalesRadiance) {
    Light light;
    light.exposure = 0.25f;
    const FloatPicture dim = display_light({1, 1, {4.0f, 0.4f, -1.0f}}, light);
    EXPECT_EQ(dim.rgb, (std::vector<float>{display_light({1, 1, {1.0f, 0, 0}}, Light()).rgb[0],
                                           display_light({1, 1, {0.1f, 0, 0}}, Light()).rgb[0], 0.0f}));
}

TEST(EncodeSrgb, RoundsTheStandardsCurve) {
    const Picture picture = encode_srgb({2, 1, {0.0f, 1.0f, 0.5f, 0.002f, 0.216f, 7.0f}});
    EXPECT_EQ(picture.width, 2u);
    EXPECT_EQ(picture.height, 1u);
    EXPECT_EQ(picture.rgba, (std::vector<uint8_t>{0, 255, 188, 255, 7, 128, 255, 255}));
}

}  // namespace
}  // namespace coppice
