// Plants in a host's picture: what is nearer is seen, colour and depth of all else stay as the host drew them.
#include <cmath>
#include <map>
#include <memory>
#include "runtime/gpu/vulkan.h"
#include "tests/draw/host_images.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

constexpr float k_host_m = 10.0f;  // what the host has drawn all over the picture
constexpr uint32_t k_host_rgba = 0xff336699u;
const VkClearColorValue k_host_color{{0x99 / 255.0f, 0x66 / 255.0f, 0x33 / 255.0f, 1.0f}};

// A square of two triangles, 50 pixels to both sides of column x.
void add_square(std::vector<PackedVertex>& vertices, float x, float z,
                PackedVertex (*at)(float, float, float)) {
    const float left = x - 50.0f, right = x + 50.0f, top = 78.0f, bottom = 178.0f;
    for (auto [column, row] :
         {std::pair{left, top}, {left, bottom}, {right, top}, {right, top}, {left, bottom}, {right, bottom}})
        vertices.push_back(at(column, row, z));
}

class HostPictureTest : public RasterTest {
  protected:
    // A square at 5 m in the left half of the picture, one at 20 m in the right one.
    void draw_into(HostImages& images, DepthConvention convention, Rasteriser& rasteriser,
                   FrameGraph& graph) {
        std::vector<PackedVertex> vertices;
        auto place = [](float x, float y, float z) { return at(x, y, z); };
        add_square(vertices, 64.0f, 5.0f, place);
        add_square(vertices, 192.0f, 20.0f, place);
        picture_shown_ = images.picture(convention);
        picture_.host = &picture_shown_;
        picture_.filter_radius_px = 2.0f;
        const auto made = rasteriser.make_host_picture(picture_shown_);
        ASSERT_TRUE(made) << to_string(made.error());
        ASSERT_TRUE(rasteriser.set_geometry({vertices, {}}));
        PartChoice choice;
        choice.triangles = 4;
        work_.begin(1);
        work_.part(0).add({}, choice, work_.part(0).add_instance({}));
        auto frame = ring_.begin();
        ASSERT_TRUE(frame);
        images.record_clears(frame->commands, k_host_color,
                             convention.depth_offset + convention.depth_scale / k_host_m);
        const auto layout = work_.gather(rasteriser.instances(0), rasteriser.entries(0));
        rasteriser.set_frame(0, layout, camera_, light_, picture_);
        graph.record(frame->commands, nullptr);
        images.record_read_back(frame->commands);
        ASSERT_TRUE(ring_.submit());
        ASSERT_TRUE(ring_.wait(frame->serial));
    }
    HostPicture picture_shown_;
};

}  // namespace

TEST_F(HostPictureTest, NearerWinsInEveryConventionOfDepth) {
    const float n = 0.1f, f = 200.0f;
    const std::map<std::string, DepthConvention> conventions{
        {"reversed, no far plane", {0.0f, n}},
        {"reversed", depth_of_projection(n / (f - n), f * n / (f - n))},
        {"near 0, far 1", depth_of_projection(-f / (f - n), -f * n / (f - n))}};
    for (const auto& [name, convention] : conventions) {
        SCOPED_TRACE(name);
        HostImages images(*device_, k_side, VK_FORMAT_R8G8B8A8_UNORM);
        ASSERT_NO_FATAL_FAILURE(draw_into(images, convention, *rasteriser_, graph_));
        const float host_depth = convention.depth_offset + convention.depth_scale / k_host_m;
        for (uint32_t y = 82; y < 174; ++y) {
            for (uint32_t x = 18; x < 110; ++x) {
                ASSERT_NE(images.color<uint32_t>(x, y), k_host_rgba) << x << " " << y;
                const float w = convention.depth_scale / (images.depth(x, y) - convention.depth_offset);
                ASSERT_NEAR(w, 5.0f, 0.01f) << x << " " << y;
            }
            for (uint32_t x = 146; x < 238; ++x) {
                ASSERT_EQ(images.color<uint32_t>(x, y), k_host_rgba) << x << " " << y;
                ASSERT_EQ(images.depth(x, y), host_depth) << x << " " << y;
            }
        }
        for (uint32_t x = 0; x < k_side; ++x) ASSERT_EQ(images.color<uint32_t>(x, 20), k_host_rgba);
        // A border shows both: neither what the host has there nor what the plant is.
        EXPECT_NE(images.color<uint32_t>(13, 128), k_host_rgba);
        EXPECT_NE(images.color<uint32_t>(13, 128), images.color<uint32_t>(60, 128));
    }
}

TEST_F(HostPictureTest, EveryFormatShowsTheSame) {
    const DepthConvention reversed{0.0f, 0.1f};
    HostImages rgba(*device_, k_side, VK_FORMAT_R8G8B8A8_UNORM),
        bgra(*device_, k_side, VK_FORMAT_B8G8R8A8_UNORM),
        linear(*device_, k_side, VK_FORMAT_R16G16B16A16_SFLOAT);
    for (HostImages* images : {&rgba, &bgra, &linear})
        ASSERT_NO_FATAL_FAILURE(draw_into(*images, reversed, *rasteriser_, graph_));
    for (uint32_t y = 0; y < k_side; y += 3)
        for (uint32_t x = 0; x < k_side; x += 3) {
            const uint32_t a = rgba.color<uint32_t>(x, y), b = bgra.color<uint32_t>(x, y);
            ASSERT_EQ(a, (b & 0xff00ff00u) | (b >> 16 & 255u) | (b & 255u) << 16) << x << " " << y;
        }
    // Linear light of the square in the left half: more than nothing, and of the host's what was cleared to.
    auto half = [](uint64_t bits) {
        return std::ldexp(float((bits & 1023u) | 1024u), int(bits >> 10 & 31u) - 25);
    };
    const uint64_t plant = linear.color<uint64_t>(60, 128), host = linear.color<uint64_t>(200, 128);
    EXPECT_GT(half(plant & 0xffff), 0.0f);
    EXPECT_NE(plant, host);
    EXPECT_NEAR(half(host & 0xffff), 0.6f, 0.001f);
    EXPECT_NEAR(half(host >> 32 & 0xffff), 0.2f, 0.001f);
}

TEST_F(HostPictureTest, WhatCannotBeDrawnIntoIsRefused) {
    HostImages images(*device_, k_side, VK_FORMAT_R8G8B8A8_UNORM);
    auto refused = [&](auto change) {
        HostPicture picture = images.picture({0.0f, 0.1f});
        change(picture);
        const auto made = rasteriser_->make_host_picture(picture);
        return !made && made.error().id == ErrorId::value_out_of_range;
    };
    EXPECT_TRUE(refused([](HostPicture& p) { p.color_format = VK_FORMAT_R32_SFLOAT; }));
    EXPECT_TRUE(refused([](HostPicture& p) { p.depth = VK_NULL_HANDLE; }));
    EXPECT_TRUE(refused([](HostPicture& p) { p.depth_format = VK_FORMAT_D16_UNORM; }));
    EXPECT_TRUE(refused([](HostPicture& p) { p.depth_scale = 0.0f; }));
    EXPECT_TRUE(refused([](HostPicture& p) { p.depth_offset = NAN; }));
    EXPECT_FALSE(refused([](HostPicture&) {}));
}

// Everything on a device whose queue the host has kept, and memory of the host's allocator.
TEST_F(HostPictureTest, WithoutAQueueGeometryComesWithTheFrame) {
    struct Allocator {
        const gpu::Device& device;
        int made = 0, released = 0;
    } allocator{*device_};
    gpu::HostDevice host{device_->instance, device_->physical, device_->handle, VK_NULL_HANDLE,
                         device_->queue_family};
    host.memory.context = &allocator;
    host.memory.allocate = [](void* context, const VkMemoryRequirements& needs,
                              VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred,
                              gpu::MemoryRange& range) {
        Allocator& self = *static_cast<Allocator*>(context);
        VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        info.allocationSize = needs.size + needs.alignment;
        info.memoryTypeIndex = self.device.find_memory_type(needs.memoryTypeBits, required, preferred);
        const VkResult result = vkAllocateMemory(self.device.handle, &info, nullptr, &range.memory);
        if (result != VK_SUCCESS) return result;
        range.offset_bytes = needs.alignment;  // somewhere inside, as of an allocator that shares memory out
        if (required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) {
            vkMapMemory(self.device.handle, range.memory, 0, VK_WHOLE_SIZE, 0, &range.mapped);
            range.mapped = static_cast<std::byte*>(range.mapped) + needs.alignment;
        }
        ++self.made;
        return VK_SUCCESS;
    };
    host.memory.release = [](void* context, const gpu::MemoryRange& range) {
        Allocator& self = *static_cast<Allocator*>(context);
        vkFreeMemory(self.device.handle, range.memory, nullptr);
        ++self.released;
    };
    {
        auto adopted = gpu::Device::adopt(host);
        ASSERT_TRUE(adopted) << to_string(adopted.error());
        EXPECT_FALSE((*adopted)->submits());
        FrameGraph graph;
        auto rasteriser = Rasteriser::create(**adopted, graph, 1, k_side, k_side);
        ASSERT_TRUE(rasteriser) << to_string(rasteriser.error());
        HostImages images(*device_, k_side, VK_FORMAT_R8G8B8A8_UNORM),
            again(*device_, k_side, VK_FORMAT_R8G8B8A8_UNORM);
        // With a queue of its own the same picture.
        ASSERT_NO_FATAL_FAILURE(draw_into(again, {0.0f, 0.1f}, *rasteriser_, graph_));
        for (int frame = 0; frame < 2; ++frame) {
            (*rasteriser)->begin_slot(0);
            ASSERT_NO_FATAL_FAILURE(draw_into(images, {0.0f, 0.1f}, **rasteriser, graph));
            for (uint32_t y = 0; y < k_side; ++y)
                for (uint32_t x = 0; x < k_side; ++x)
                    ASSERT_EQ(images.color<uint32_t>(x, y), again.color<uint32_t>(x, y)) << x << " " << y;
        }
        // What is loaded leaves nothing behind once a frame has taken it.
        const uint64_t loaded_bytes = (*rasteriser)->gpu_bytes();
        (*rasteriser)->begin_slot(0);
        EXPECT_LT((*rasteriser)->gpu_bytes(), loaded_bytes);

        std::array<std::byte, 16> bytes{};
        const auto read = gpu::read_now(**adopted, (*rasteriser)->color(), 0, bytes);
        ASSERT_FALSE(read);
        EXPECT_EQ(read.error().id, ErrorId::usage);
    }
    EXPECT_GT(allocator.made, 10);
    EXPECT_EQ(allocator.made, allocator.released);
}

}  // namespace coppice
