// Cells of a large plant that choose their levels for themselves cover together what the plant covers, from
// nearby where each chooses otherwise, and leaving out what lies outside the view changes no pixel.
#include <gtest/gtest.h>
#include "tests/images/cook_species.h"
#include "plugins/vegetation/report/plant_picture.h"

namespace coppice {
namespace {

constexpr double k_bound = 0.03;
constexpr uint32_t k_side = 512;

class OctreeAgreement : public ::testing::Test {
  protected:
    void SetUp() override {
        gpu::DeviceSettings settings;
        settings.validation = true;
        auto device = gpu::Device::create(settings);
        ASSERT_TRUE(device) << to_string(device.error());
        device_ = std::move(*device);
        auto plant = cook_species("oak");
        ASSERT_TRUE(plant) << to_string(plant.error());
        auto picture = PlantPicture::create(*device_, std::move(*plant), k_side);
        ASSERT_TRUE(picture) << to_string(picture.error());
        picture_ = std::move(*picture);
        ASSERT_TRUE(picture_->model().has_cells);
    }
    void TearDown() override {
        if (device_) {
            EXPECT_EQ(device_->validation_messages(), 0u);
        }
    }

    // From that many radii before the plant's middle, around it by index; beside: looking past it by that
    // angle.
    PictureMean draw(float radii, int index, bool inside, const FrameSettings& settings,
                     float beside_rad = 0.0f) {
        Camera camera;
        camera.position_world = dvec3(0.0);
        camera.vertical_fov_rad = 1.2f;
        camera.yaw_rad = 2.4f * float(index);
        camera.pitch_rad = -0.3f * float(index % 3);
        const vec3 center = camera.forward() * (radii * picture_->model().radius_m);
        camera.yaw_rad += beside_rad;
        auto mean = picture_->draw_from(camera, center - picture_->model().center_plant, inside, settings);
        EXPECT_TRUE(mean) << to_string(mean.error());
        return mean ? *mean : PictureMean{};
    }

    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<PlantPicture> picture_;
};

TEST_F(OctreeAgreement, CellsCoverTogetherWhatThePlantCovers) {
    FrameSettings full;
    full.level_of_detail = false;
    for (float radii : {0.8f, 1.2f, 2.0f, 3.5f, 6.0f})
        for (float d : {1.0f, 2.0f}) {
            FrameSettings lod;
            lod.sample_distance_px = d;
            double drawn = 0.0, wanted = 0.0;
            uint64_t triangles = 0, points = 0;
            for (int index = 0; index < 6; ++index) {
                drawn += draw(radii, index, false, lod).coverage_px;
                triangles += picture_->work().triangles;
                points += picture_->work().points;
                wanted += draw(radii, index, true, full).coverage_px;
            }
            std::printf(
                "%.1f radii, d' = %.0f px: coverage %+5.2f %% of %.0f px, %llu triangles, %llu points\n",
                double(radii), double(d), 100.0 * (drawn / wanted - 1.0), wanted,
                static_cast<unsigned long long>(triangles), static_cast<unsigned long long>(points));
            EXPECT_NEAR(drawn / wanted, 1.0, k_bound) << radii << " radii, d' = " << d;
        }
}

TEST_F(OctreeAgreement, WhatIsLeftOutOutsideTheViewChangesNoPixel) {
    FrameSettings full;
    full.level_of_detail = false;
    uint64_t left_out = 0;
    for (float radii : {0.0f, 0.5f, 1.1f})
        for (int index = 0; index < 4; ++index) {
            draw(radii, index, true, full, 0.6f);
            const std::vector<uint64_t> all = picture_->words;
            const uint64_t triangles = picture_->work().triangles;
            draw(radii, index, false, full, 0.6f);
            EXPECT_TRUE(picture_->words == all) << radii << " radii, view " << index;
            left_out += triangles - picture_->work().triangles;
        }
    EXPECT_GT(left_out, 0u);
}

}  // namespace
}  // namespace coppice
