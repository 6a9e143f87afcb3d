#include "plugins/vegetation/lod/rest.h"

#include <gtest/gtest.h>
#include <array>

namespace coppice {
namespace {

constexpr uint32_t k_frames = 4096;

FrameSettings some_settings() {
    FrameSettings settings;
    settings.sample_distance_px = 1.7f;
    settings.filter_radius_px = 1.8f;
    return settings;
}

TEST(RestingFrame, TheFirstIsTheFrameOfAMovingView) {
    const FrameSettings settings = some_settings();
    const RestingFrame first = resting_frame(0, settings);
    EXPECT_EQ(first.shift_px, vec2(0.0f));
    EXPECT_EQ(first.new_share, 1.0f);
    EXPECT_EQ(first.sample_distance_px, settings.sample_distance_px);
    EXPECT_EQ(first.filter_radius_px, settings.filter_radius_px);
    EXPECT_EQ(first.index, 0u);
}

// Of 16 places in a row 2 to 6 lie in each quarter of the pixel; chance alone leaves quarters empty.
TEST(RestingFrame, EveryRunOfFramesIsSpreadOverThePixel) {
    constexpr uint32_t k_run = 16;
    std::array<int, 4> in_quadrant{};
    auto quadrant_of = [](uint32_t index) {
        const vec2 shift = resting_frame(index, some_settings()).shift_px;
        return size_t(shift.x < 0.0f) + 2 * size_t(shift.y < 0.0f);
    };
    for (uint32_t index = 0; index < k_frames; ++index) {
        const vec2 shift = resting_frame(index, some_settings()).shift_px;
        ASSERT_LE(std::max(std::fabs(shift.x), std::fabs(shift.y)), 0.5f) << index;
        ++in_quadrant[quadrant_of(index)];
        if (index >= k_run) --in_quadrant[quadrant_of(index - k_run)];
        if (index + 1 < k_run) continue;
        for (int count : in_quadrant) {
            ASSERT_GE(count, 2) << index;
            ASSERT_LE(count, 6) << index;
        }
    }
}

// Else frames after the first would add the same points again.
TEST(RestingFrame, EachDrawsOtherPoints) {
    for (uint32_t index = 0; index < 100; ++index)
        EXPECT_EQ(resting_frame(index, some_settings()).index, index);
}

TEST(RestingFrame, LaterFramesAreNeverCoarser) {
    for (float d : {0.5f, 1.0f, 4.0f})
        for (float radius : {1.0f, 1.5f, 2.0f}) {
            FrameSettings settings;
            settings.sample_distance_px = d;
            settings.filter_radius_px = radius;
            RestingFrame before = resting_frame(0, settings);
            for (uint32_t index = 1; index < k_frames; ++index) {
                const RestingFrame frame = resting_frame(index, settings);
                ASSERT_GT(frame.sample_distance_px, 0.0f);
                ASSERT_LE(frame.sample_distance_px, before.sample_distance_px) << index;
                ASSERT_GE(frame.filter_radius_px, 1.0f);
                ASSERT_LE(frame.filter_radius_px, before.filter_radius_px) << index;
                before = frame;
            }
            EXPECT_LT(before.sample_distance_px, d);
        }
}

// A share over 1 would subtract the frames before; one of 0 would waste the frame; and where shares did not fall, the
// last frames' noise would stay.
TEST(RestingFrame, SharesMakeAMeanThatSettles) {
    float before = 1.0f;
    for (uint32_t index = 1; index < k_frames; ++index) {
        const float share = resting_frame(index, some_settings()).new_share;
        ASSERT_GT(share, 0.0f);
        ASSERT_LE(share, before) << index;
        before = share;
    }
    EXPECT_LT(resting_frame(64, some_settings()).new_share, 0.1f);
}

}  // namespace
}  // namespace coppice
