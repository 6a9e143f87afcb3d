// A crown drawn with fewer and fewer joined leaves covers what all its leaves cover, from the side and from above, and
// from one level to the next hardly a pixel changes.
#include <gtest/gtest.h>
#include "plugins/vegetation/cook/cook_plant.h"
#include "tests/foliage/made_crown.h"
#include "plugins/vegetation/report/plant_picture.h"

namespace coppice {
namespace {

constexpr float k_height_px = 300.0f;
constexpr uint32_t k_leaves = 6000;

class LeafAgreement : public ::testing::Test {
  protected:
    void SetUp() override {
        gpu::DeviceSettings settings;
        settings.validation = true;
        auto device = gpu::Device::create(settings);
        ASSERT_TRUE(device) << to_string(device.error());
        device_ = std::move(*device);
        PlantDescription description;
        description.name = "crown";
        PartDescription& part = description.parts.emplace_back();
        part.leaf = true;
        for (const Leaf& leaf : made_crown(k_leaves, 3)) {
            const uint32_t first = uint32_t(part.vertices.size());
            for (const vec3& corner : leaf.corners_plant)
                part.vertices.push_back({corner, leaf.normal_plant, leaf.color_linear});
            for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) part.indices.push_back(first + k);
        }
        auto bytes = cook_plant(description, {});
        ASSERT_TRUE(bytes) << to_string(bytes.error());
        auto plant = load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(*bytes)), "crown");
        ASSERT_TRUE(plant) << to_string(plant.error());
        ASSERT_EQ(plant->crowns.size(), 1u);
        EXPECT_EQ(plant->crowns[0].full_count, k_leaves);
        auto picture = PlantPicture::create(*device_, std::move(*plant), 512);
        ASSERT_TRUE(picture) << to_string(picture.error());
        picture_ = std::move(*picture);
    }
    void TearDown() override {
        if (device_) {
            EXPECT_EQ(device_->validation_messages(), 0u);
        }
    }

    double coverage_px(float yaw_rad, float pitch_rad, const FrameSettings& settings) {
        double sum = 0.0;
        for (int shift = 0; shift < 4; ++shift) {
            auto mean = picture_->draw(k_height_px, yaw_rad, pitch_rad,
                                       {0.25f + 0.5f * float(shift & 1), 0.25f + 0.5f * float(shift / 2)}, settings);
            EXPECT_TRUE(mean);
            if (mean) sum += mean->coverage_px;
        }
        return sum;
    }
    // d' at which so many leaves are drawn.
    FrameSettings settings_for(float count) {
        FrameSettings settings;
        settings.foliage = FoliageMode::leaves;
        float finer_px = 0.25f, coarser_px = 64.0f;
        for (int step = 0; step < 14; ++step) {
            settings.sample_distance_px = std::sqrt(finer_px * coarser_px);
            EXPECT_TRUE(picture_->draw(k_height_px, 0.3f, 0.0f, {}, settings));
            const bool too_fine = picture_->work().triangles > 0 || float(picture_->work().leaves) > count;
            (too_fine ? finer_px : coarser_px) = settings.sample_distance_px;
        }
        return settings;
    }

    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<PlantPicture> picture_;
};

TEST_F(LeafAgreement, EveryOctaveCoversWhatTheCrownCovers) {
    FrameSettings full;
    full.level_of_detail = false;
    for (float octave = 0.0f; octave <= 4.5f; octave += 0.5f) {
        const float count = float(k_leaves) * 0.98f * std::exp2(-octave);
        const FrameSettings settings = settings_for(count);
        for (bool above : {false, true}) {
            double drawn = 0.0, expected = 0.0;
            for (int i = 0; i < 6; ++i) {
                const float yaw = 1.047f * float(i), pitch = above ? -1.2f - 0.06f * float(i) : -0.1f * float(i % 3);
                drawn += coverage_px(yaw, pitch, settings);
                expected += coverage_px(yaw, pitch, full);
            }
            EXPECT_TRUE(picture_->draw(k_height_px, 0.3f, 0.0f, {}, settings));
            EXPECT_NEAR(double(picture_->work().leaves), double(count), 0.03 * double(count));
            EXPECT_EQ(picture_->work().triangles + picture_->work().points, 0u);
            std::printf("%5.0f leaves from %s: %+5.2f %%\n", double(count), above ? "above" : "the side",
                        100.0 * (drawn / expected - 1.0));
            EXPECT_NEAR(drawn / expected, 1.0, 0.02) << count << (above ? " from above" : " from the side");
        }
    }
}

TEST_F(LeafAgreement, FromOneLevelToTheNextHardlyAPixelChanges) {
    for (float count : {5000.0f, 2990.0f, 1500.0f, 700.0f, 300.0f}) {
        FrameSettings settings = settings_for(count);
        ASSERT_TRUE(picture_->draw(k_height_px, 0.3f, -0.2f, {}, settings));
        const uint64_t leaves = picture_->work().leaves;
        const std::vector<uint64_t> before = picture_->words;
        settings.sample_distance_px *= 1.005f;  // 1 % fewer leaves: 2 % go and 1 % come
        ASSERT_TRUE(picture_->draw(k_height_px, 0.3f, -0.2f, {}, settings));
        EXPECT_LT(picture_->work().leaves, leaves);
        size_t covered = 0, changed = 0;
        for (size_t i = 0; i < before.size(); ++i) {
            covered += before[i] != 0;
            changed += before[i] != picture_->words[i];
        }
        std::printf("%4.0f leaves: %.2f %% of what is covered changes\n", double(count),
                    100.0 * double(changed) / double(covered));
        EXPECT_LE(double(changed), 0.04 * double(covered)) << count;
    }
}

}  // namespace
}  // namespace coppice
