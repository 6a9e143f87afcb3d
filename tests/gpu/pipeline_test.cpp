#include "runtime/gpu/pipeline.h"
#include "runtime/gpu/vulkan.h"

#include <algorithm>
#include <vector>
#include "runtime/gpu/commands.h"
#include "shaders/keep_greatest.comp.h"
#include "shaders/write_arguments.comp.h"
#include "tests/gpu/validated_device.h"

namespace coppice::gpu {
namespace {

struct Push {
    uint32_t key_count, word_count;
};

struct KeepGreatest : ValidatedDevice {
    static constexpr BindingKind k_bindings[] = {BindingKind::storage, BindingKind::texel};

    void make(uint32_t key_count, uint32_t word_count, uint32_t group_size, uint32_t scale) {
        push = {key_count, word_count};
        keys.resize(key_count);
        for (uint32_t i = 0; i < key_count; i++) keys[i] = (i * 2654435761u) >> 8;
        auto key_buffer = Buffer::create(
            *device, {.size_bytes = key_count * 4ull, .texel_format = VK_FORMAT_R32_UINT, .name = "keys"});
        ASSERT_TRUE(key_buffer) << to_string(key_buffer.error());
        key_texels = std::move(*key_buffer);
        ASSERT_TRUE(upload_now(*device, key_texels, 0, std::as_bytes(std::span(keys))));
        auto word_buffer = Buffer::create(*device, {.size_bytes = word_count * 8ull, .name = "words"});
        ASSERT_TRUE(word_buffer) << to_string(word_buffer.error());
        words = std::move(*word_buffer);
        std::vector<uint64_t> zero(word_count, 0);
        ASSERT_TRUE(upload_now(*device, words, 0, std::as_bytes(std::span(zero))));
        const uint32_t constants[] = {group_size, scale};
        auto made = Pipeline::create(*device, {.name = "keep greatest",
                                               .spirv = k_keep_greatest_spirv,
                                               .bindings = k_bindings,
                                               .push_constant_bytes = sizeof(Push),
                                               .specialization = constants});
        ASSERT_TRUE(made) << to_string(made.error());
        pipeline = std::move(*made);
        auto made_ring = CommandRing::create(*device, 1);
        ASSERT_TRUE(made_ring) << to_string(made_ring.error());
        ring = std::move(*made_ring);
    }

    void expect_greatest(uint32_t key_count, uint32_t scale) {
        std::vector<uint64_t> expected(push.word_count, 0), read(push.word_count);
        for (uint32_t i = 0; i < key_count; i++) {
            uint64_t& word = expected[i % push.word_count];
            word = std::max(word, uint64_t(keys[i] * scale) << 32 | i);
        }
        ASSERT_TRUE(read_now(*device, words, 0, std::as_writable_bytes(std::span(read))));
        EXPECT_TRUE(read == expected);
    }

    void bind(VkCommandBuffer commands) {
        const BoundBuffer buffers[] = {&words, &key_texels};
        pipeline.bind(commands, buffers, &push, sizeof(push));
    }

    void TearDown() override {
        ring = {};
        pipeline = {};
        key_texels = Buffer{};
        words = Buffer{};
        ValidatedDevice::TearDown();
    }

    Push push;
    std::vector<uint32_t> keys;
    Buffer key_texels, words;
    Pipeline pipeline;
    CommandRing ring;
};

TEST_F(KeepGreatest, by_64_bit_atomics_for_any_group_size_and_constant) {
    for (uint32_t group_size : {8u, 64u}) {
        make(100'003, 97, group_size, group_size == 8 ? 1 : 3);
        auto frame = ring.begin();
        ASSERT_TRUE(frame) << to_string(frame.error());
        bind(frame->commands);
        pipeline.dispatch(frame->commands, (push.key_count - 1) / group_size + 1);
        ASSERT_TRUE(ring.submit());
        ASSERT_TRUE(ring.wait(frame->serial));
        expect_greatest(push.key_count, group_size == 8 ? 1 : 3);
    }
}

TEST_F(KeepGreatest, over_more_groups_than_an_axis_holds) {
    if (device->limits.groups_per_axis > 100'000) GTEST_SKIP() << "one axis holds all";
    make(140'001, 1'000, 1, 1);
    ASSERT_GT(push.key_count, device->limits.groups_per_axis);
    auto frame = ring.begin();
    ASSERT_TRUE(frame);
    bind(frame->commands);
    pipeline.dispatch(frame->commands, push.key_count);
    ASSERT_TRUE(ring.submit());
    expect_greatest(push.key_count, 1);
}

TEST_F(KeepGreatest, nothing_for_no_groups) {
    make(100, 10, 8, 1);
    auto frame = ring.begin();
    ASSERT_TRUE(frame);
    bind(frame->commands);
    pipeline.dispatch(frame->commands, 0);
    ASSERT_TRUE(ring.submit());
    expect_greatest(0, 1);
}

TEST_F(KeepGreatest, as_many_as_the_device_says) {
    make(100'000, 10, 8, 1);
    const uint32_t constants[] = {1};
    const BindingKind bindings[] = {BindingKind::storage};
    auto writer = Pipeline::create(*device, {.name = "write arguments",
                                             .spirv = k_write_arguments_spirv,
                                             .bindings = bindings,
                                             .push_constant_bytes = 4,
                                             .specialization = constants});
    ASSERT_TRUE(writer) << to_string(writer.error());
    auto arguments = Buffer::create(
        *device, {.size_bytes = 16,
                  .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT});
    ASSERT_TRUE(arguments);
    auto frame = ring.begin();
    ASSERT_TRUE(frame);
    const BoundBuffer buffers[] = {&*arguments};
    uint32_t group_count = 1'111;
    writer->bind(frame->commands, buffers, &group_count, 4);
    writer->dispatch(frame->commands, 1);
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(frame->commands, &dependency);
    bind(frame->commands);
    pipeline.dispatch_indirect(frame->commands, *arguments, 4);
    ASSERT_TRUE(ring.submit());
    ASSERT_TRUE(ring.wait(frame->serial));
    expect_greatest(group_count * 8, 1);
}

}  // namespace
}  // namespace coppice::gpu
