// Draws hand-made primitives with the rasteriser and reads the visibility buffer and the picture back, under the
// validation layer.
#pragma once
#include <gtest/gtest.h>
#include <bit>
#include <vector>
#include "plugins/vegetation/draw/rasteriser.h"
#include "runtime/core/random.h"

namespace coppice {

class RasterTest : public ::testing::Test {
  protected:
    static constexpr uint32_t k_side = 256;

    void SetUp() override {
        gpu::DeviceSettings settings;
        settings.validation = true;
        auto device = gpu::Device::create(settings);
        ASSERT_TRUE(device) << to_string(device.error());
        device_ = std::move(*device);
        auto rasteriser = Rasteriser::create(*device_, graph_, 1, k_side, k_side);
        ASSERT_TRUE(rasteriser) << to_string(rasteriser.error());
        rasteriser_ = std::move(*rasteriser);
        auto ring = gpu::CommandRing::create(*device_, 1);
        ASSERT_TRUE(ring);
        ring_ = std::move(*ring);
        camera_.position_world = dvec3(0.0);
        camera_.vertical_fov_rad = 1.5707963f;  // focal length 128 px: at 128 m a metre is a pixel
    }
    void TearDown() override {
        if (device_) {
            EXPECT_EQ(device_->validation_messages(), 0u);
        }
    }

    // Where column x, row y (pixels, fractions allowed) lies at distance z.
    static PackedVertex at(float x, float y, float z, uint32_t surface = 1u) {
        return {(x - 128.0f) * z / 128.0f, (128.0f - y) * z / 128.0f, -z, surface};
    }
    void draw(const std::vector<PackedVertex>& vertices, const PartChoice& choice,
              const std::vector<uint32_t>& owners = {}) {
        work_.begin(1);
        work_.part(0).add({}, choice, work_.part(0).add_instance({}));
        ASSERT_TRUE(rasteriser_->set_geometry({vertices, owners}));
        draw_work();
    }
    void draw_work() {
        auto layout = work_.gather(rasteriser_->instances(0), rasteriser_->entries(0));
        EXPECT_EQ(layout.dropped_entries, 0u);
        auto frame = ring_.begin();
        ASSERT_TRUE(frame);
        ASSERT_TRUE(rasteriser_->make_shadow_maps(shadow_.side_texels, map_count_));
        rasteriser_->set_frame(0, layout, camera_, light_, picture_, shadow_);
        graph_.record(frame->commands, frame->timestamps);
        ASSERT_TRUE(ring_.submit());
        ASSERT_TRUE(ring_.wait(frame->serial));
        words_.resize(size_t(rasteriser_->width()) * rasteriser_->height());
        ASSERT_TRUE(
            gpu::read_now(*device_, rasteriser_->visibility(), 0, std::as_writable_bytes(std::span(words_))));
    }
    // Four bytes a pixel, red lowest.
    std::vector<uint32_t> colors() const {
        std::vector<uint32_t> rgba(size_t(rasteriser_->width()) * rasteriser_->height());
        EXPECT_TRUE(
            gpu::read_now(*device_, rasteriser_->color(), 0, std::as_writable_bytes(std::span(rgba))));
        return rgba;
    }
    uint64_t word(uint32_t x, uint32_t y) const { return words_[size_t(y) * k_side + x]; }
    float depth(uint32_t x, uint32_t y) const { return std::bit_cast<float>(uint32_t(word(x, y) >> 32)); }
    size_t covered() const {
        size_t count = 0;
        for (uint64_t w : words_) count += w != 0;
        return count;
    }

    FrameGraph graph_;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<Rasteriser> rasteriser_;
    gpu::CommandRing ring_;
    Camera camera_;
    Light light_;
    PictureSettings picture_;
    ShadowSettings shadow_;
    uint32_t map_count_ = 1;
    WorkList work_;
    std::vector<uint64_t> words_;
};

}  // namespace coppice
