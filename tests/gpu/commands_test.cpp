#include "runtime/gpu/commands.h"

#include <string>
#include <vector>
#include "runtime/gpu/buffer.h"
#include "tests/gpu/validated_device.h"
#include "runtime/gpu/vulkan.h"

namespace coppice::gpu {
namespace {

using Commands = ValidatedDevice;

TEST_F(Commands, frames_in_flight_keep_apart) {
    constexpr uint32_t k_slots = 3;
    auto ring = CommandRing::create(*device, k_slots);
    ASSERT_TRUE(ring) << to_string(ring.error());
    EXPECT_EQ(ring->slots(), k_slots);
    std::vector<Buffer> buffers;
    for (uint32_t i = 0; i < k_slots; i++) {
        auto buffer = Buffer::create(*device, {.size_bytes = 1 << 16, .memory = MemoryUse::readback});
        ASSERT_TRUE(buffer);
        buffers.push_back(std::move(*buffer));
    }
    for (uint32_t i = 0; i < 50; i++) {
        auto frame = ring->begin();
        ASSERT_TRUE(frame) << to_string(frame.error());
        EXPECT_EQ(frame->serial, i + 1);
        EXPECT_EQ(frame->slot, i % k_slots);
        std::span<uint32_t> words = buffers[frame->slot].mapped_as<uint32_t>();
        if (i >= k_slots) {  // begin() waited for this slot's last frame
            EXPECT_EQ(words.front(), i - k_slots);
            EXPECT_EQ(words.back(), i - k_slots);
        }
        vkCmdFillBuffer(frame->commands, buffers[frame->slot].handle(), 0, VK_WHOLE_SIZE, i);
        VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        barrier.srcStageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
        barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
        barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
        barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
        VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        dependency.memoryBarrierCount = 1;
        dependency.pMemoryBarriers = &barrier;
        vkCmdPipelineBarrier2(frame->commands, &dependency);
        ASSERT_TRUE(ring->submit());
    }
    ASSERT_TRUE(ring->wait(50));
    EXPECT_EQ(buffers[49 % k_slots].mapped_as<uint32_t>().front(), 49u);
}

TEST_F(Commands, sections_are_timed_by_name) {
    if (device->limits.timestamp_ns == 0.0) GTEST_SKIP() << "no timestamps";
    auto buffer = Buffer::create(*device, {.size_bytes = 64 << 20});
    ASSERT_TRUE(buffer);
    auto ring = CommandRing::create(*device, 1);  // ends first: the buffer is still in use then
    ASSERT_TRUE(ring);
    for (int i = 0; i < 3; i++) {
        auto frame = ring->begin();
        ASSERT_TRUE(frame);
        if (i == 0) {
            EXPECT_TRUE(frame->timestamps->sections().empty());
        } else {
            std::span<const Timestamps::Section> sections = frame->timestamps->sections();
            ASSERT_EQ(sections.size(), 3u);
            EXPECT_STREQ(sections[0].name, "large");
            EXPECT_STREQ(sections[1].name, "empty");
            EXPECT_STREQ(sections[2].name, "last");
            EXPECT_GT(sections[0].ms, 0.0);
            EXPECT_NEAR(frame->timestamps->total_ms(), sections[0].ms + sections[1].ms + sections[2].ms,
                        1e-9);
        }
        frame->timestamps->begin(frame->commands, "large");
        vkCmdFillBuffer(frame->commands, buffer->handle(), 0, VK_WHOLE_SIZE, 1);
        frame->timestamps->begin(frame->commands, "empty");
        frame->timestamps->end(frame->commands);
        frame->timestamps->end(frame->commands);
        frame->timestamps->begin(frame->commands, "last");  // ended by submit
        ASSERT_TRUE(ring->submit());
    }
}

TEST_F(Commands, sections_past_the_limit_are_not_timed) {
    auto ring = CommandRing::create(*device, 1);
    ASSERT_TRUE(ring);
    for (int i = 0; i < 2; i++) {
        auto frame = ring->begin();
        ASSERT_TRUE(frame);
        if (i && device->limits.timestamp_ns > 0.0) {
            EXPECT_GE(frame->timestamps->sections().size(), Timestamps::k_section_limit);
            EXPECT_LE(frame->timestamps->sections().size(), 2 * Timestamps::k_section_limit);
        }
        for (uint32_t k = 0; k < 5 * Timestamps::k_section_limit; k++)
            frame->timestamps->begin(frame->commands, "many");
        ASSERT_TRUE(ring->submit());
    }
}

TEST_F(Commands, a_frame_begun_and_dropped_is_begun_again) {
    auto ring = CommandRing::create(*device, 2);
    ASSERT_TRUE(ring);
    auto first = ring->begin();
    ASSERT_TRUE(first);
    auto second = ring->begin();
    ASSERT_TRUE(second);
    EXPECT_EQ(first->serial, second->serial);
    ASSERT_TRUE(ring->submit());
    ASSERT_TRUE(ring->wait(second->serial));
}

}  // namespace
}  // namespace coppice::gpu
