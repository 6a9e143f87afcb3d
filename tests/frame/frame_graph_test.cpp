#include "runtime/frame/frame_graph.h"

#include <numeric>
#include <string>
#include <vector>
#include "runtime/gpu/pipeline.h"
#include "shaders/affine.comp.h"
#include "shaders/count.comp.h"
#include "tests/gpu/validated_device.h"
#include "runtime/gpu/vulkan.h"

namespace coppice {
namespace {

using gpu::BindingKind;
using gpu::Buffer;

constexpr uint32_t k_element_count = 20'000, k_slots = 2;

struct Push {
    uint32_t element_count, factor_or_counter_count, term_or_amount;
};

struct Frames : gpu::ValidatedDevice {
    void SetUp() override {
        ValidatedDevice::SetUp();
        ASSERT_TRUE(device);
        const BindingKind two[] = {BindingKind::storage, BindingKind::storage},
                          one[] = {BindingKind::storage};
        const uint32_t constants[] = {device->limits.group_size};
        auto make = [&](const char* name, std::span<const uint32_t> spirv,
                        std::span<const BindingKind> bindings) {
            auto made = gpu::Pipeline::create(*device, {.name = name,
                                                        .spirv = spirv,
                                                        .bindings = bindings,
                                                        .push_constant_bytes = sizeof(Push),
                                                        .specialization = constants});
            EXPECT_TRUE(made) << to_string(made.error());
            return made ? std::move(*made) : gpu::Pipeline{};
        };
        affine = make("affine", k_affine_spirv, two);
        count = make("count", k_count_spirv, one);
        auto made = gpu::CommandRing::create(*device, k_slots);
        ASSERT_TRUE(made);
        ring = std::move(*made);
    }

    void TearDown() override {
        ring = {};  // first: waits for the device
        buffers.clear();
        affine = gpu::Pipeline{};
        count = gpu::Pipeline{};
        ValidatedDevice::TearDown();
    }

    const Buffer* make_buffer(const char* name, gpu::MemoryUse memory = gpu::MemoryUse::device) {
        auto made = Buffer::create(
            *device, {.size_bytes = k_element_count * 4,
                      .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
                      .memory = memory,
                      .name = name});
        EXPECT_TRUE(made) << to_string(made.error());
        buffers.push_back(std::make_unique<Buffer>(std::move(*made)));
        return buffers.back().get();
    }

    FrameGraph::Record compute(ResourceIndex source, ResourceIndex target, uint32_t factor,
                               const uint32_t* term) {
        return [this, source, target, factor, term](VkCommandBuffer commands) {
            const gpu::BoundBuffer bound[] = {graph.buffer(source), graph.buffer(target)};
            Push push{k_element_count, factor, *term};
            affine.bind(commands, bound, &push, sizeof(push));
            affine.dispatch(commands, (k_element_count - 1) / device->limits.group_size + 1);
        };
    }

    FrameGraph::Record add(ResourceIndex counters, uint32_t counter_count, uint32_t amount) {
        return [this, counters, counter_count, amount](VkCommandBuffer commands) {
            const gpu::BoundBuffer bound[] = {graph.buffer(counters)};
            Push push{k_element_count, counter_count, amount};
            count.bind(commands, bound, &push, sizeof(push));
            count.dispatch(commands, (k_element_count - 1) / device->limits.group_size + 1);
        };
    }

    FrameGraph::Record copy(ResourceIndex source, ResourceIndex target) {
        return [this, source, target](VkCommandBuffer commands) {
            VkBufferCopy region{0, 0, k_element_count * 4};
            vkCmdCopyBuffer(commands, graph.buffer(source)->handle(), graph.buffer(target)->handle(), 1,
                            &region);
        };
    }

    FrameGraph::Record fill(ResourceIndex target, const uint32_t* value) {
        return [this, target, value](VkCommandBuffer commands) {
            vkCmdFillBuffer(commands, graph.buffer(target)->handle(), 0, VK_WHOLE_SIZE, *value);
        };
    }

    gpu::Pipeline affine, count;
    gpu::CommandRing ring;
    FrameGraph graph;
    std::vector<std::unique_ptr<Buffer>> buffers;
};

// fill -> compute -> compute back over the filled buffer -> copy out, every frame into the slot's own buffer.
TEST_F(Frames, read_and_write_hazards_give_the_right_values_over_a_hundred_frames) {
    const Buffer* results[k_slots] = {make_buffer("result 0", gpu::MemoryUse::readback),
                                      make_buffer("result 1", gpu::MemoryUse::readback)};
    ResourceIndex a = graph.add_buffer("a", make_buffer("a")), b = graph.add_buffer("b", make_buffer("b")),
                  sum = graph.add_buffer("sum", make_buffer("sum")),
                  result = graph.add_buffer("result", results[0]);
    uint32_t start = 0, five = 5, zero = 0;
    graph.add_pass("fill", {{a, BufferAccess::transfer_write}}, fill(a, &start));
    graph.add_pass("refill", {{a, BufferAccess::transfer_write}}, fill(a, &start));  // write after write
    graph.add_pass("triple", {{a, BufferAccess::compute_read}, {b, BufferAccess::compute_write}},
                   compute(a, b, 3, &five));
    graph.add_pass("back",
                   {{b, BufferAccess::compute_read}, {a, BufferAccess::compute_write}},  // write after read
                   compute(b, a, 2, &zero));
    graph.add_pass("keep",
                   {{b, BufferAccess::compute_read}, {sum, BufferAccess::compute_write}},  // no barrier
                   compute(b, sum, 1, &zero));
    graph.add_pass("double", {{a, BufferAccess::compute_read}, {b, BufferAccess::compute_write}},
                   compute(a, b, 1, &zero));
    graph.add_pass("copy",
                   {{b, BufferAccess::transfer_read},
                    {result, BufferAccess::transfer_write},
                    {result, BufferAccess::host_read}},
                   copy(b, result));
    for (uint32_t i = 0; i < 100; i++) {
        auto frame = ring.begin();
        ASSERT_TRUE(frame) << to_string(frame.error());
        for (uint32_t value :
             i < k_slots ? std::span<uint32_t>() : results[frame->slot]->mapped_as<uint32_t>())
            ASSERT_EQ(value, ((i - k_slots) * 3 + 5) * 2) << "frame " << i - k_slots;
        start = i;
        graph.set_buffer(result, results[frame->slot]);
        graph.record(frame->commands, frame->timestamps);
        ASSERT_TRUE(ring.submit());
    }
    auto frame = ring.begin();
    ASSERT_TRUE(frame);
    std::span<const gpu::Timestamps::Section> sections = frame->timestamps->sections();
    if (device->limits.timestamp_ns > 0.0) {
        ASSERT_EQ(sections.size(), 7u);
        EXPECT_STREQ(sections[0].name, "fill");
        EXPECT_STREQ(sections[6].name, "copy");
    }
    std::string text = graph.describe();
    auto line = [&](const char* pass) {
        size_t from = text.find(std::string(pass) + ":");
        return text.substr(from, text.find('\n', from) - from);
    };
    EXPECT_EQ(line("fill"), "fill: transfer write a; waits for compute") << text;
    EXPECT_EQ(line("refill"), "refill: transfer write a; waits for transfer") << text;
    EXPECT_EQ(line("triple"), "triple: compute read a, compute write b; waits for compute transfer") << text;
    EXPECT_EQ(line("keep"), "keep: compute read b, compute write sum") << text;
}

TEST_F(Frames, state_carried_from_frame_to_frame_is_ordered) {
    ResourceIndex a = graph.add_buffer("a", make_buffer("a")), b = graph.add_buffer("b", make_buffer("b"));
    std::vector<uint32_t> values(k_element_count);
    std::iota(values.begin(), values.end(), 0u);
    ASSERT_TRUE(upload_now(*device, *graph.buffer(a), 0, std::as_bytes(std::span(values))));
    uint32_t seven = 7, one = 1;
    graph.add_pass("there", {{a, BufferAccess::compute_read}, {b, BufferAccess::compute_write}},
                   compute(a, b, 3, &seven));
    graph.add_pass("back", {{b, BufferAccess::compute_read}, {a, BufferAccess::compute_write}},
                   compute(b, a, 5, &one));
    for (uint32_t i = 0; i < 100; i++) {
        auto frame = ring.begin();
        ASSERT_TRUE(frame);
        graph.record(frame->commands, nullptr);
        ASSERT_TRUE(ring.submit());
        for (uint32_t& value : values) value = (value * 3 + 7) * 5 + 1;
    }
    std::vector<uint32_t> read(k_element_count);
    ASSERT_TRUE(read_now(*device, *graph.buffer(a), 0, std::as_writable_bytes(std::span(read))));
    EXPECT_TRUE(read == values);
}

TEST_F(Frames, consecutive_atomics_have_no_barrier_and_count_right) {
    ResourceIndex counters = graph.add_buffer("counters", make_buffer("counters"));
    uint32_t zero = 0;
    graph.add_pass("clear", {{counters, BufferAccess::transfer_write}}, fill(counters, &zero));
    graph.add_pass("ones", {{counters, BufferAccess::compute_atomic}}, add(counters, 10, 1));
    graph.add_pass("fives", {{counters, BufferAccess::compute_atomic}}, add(counters, 10, 5));
    graph.add_pass("more", {{counters, BufferAccess::compute_read_write}}, add(counters, 10, 100));
    for (uint32_t i = 0; i < 20; i++) {
        auto frame = ring.begin();
        ASSERT_TRUE(frame);
        graph.record(frame->commands, frame->timestamps);
        ASSERT_TRUE(ring.submit());
    }
    std::vector<uint32_t> read(10);
    ASSERT_TRUE(read_now(*device, *graph.buffer(counters), 0, std::as_writable_bytes(std::span(read))));
    EXPECT_EQ(read, std::vector<uint32_t>(10, k_element_count / 10 * 106));
    std::string text = graph.describe();
    EXPECT_NE(text.find("fives: compute atomic counters\n"), std::string::npos) << text;
    EXPECT_NE(text.find("more: compute read-write counters; waits for compute\n"), std::string::npos) << text;
}

TEST_F(Frames, an_indirect_dispatch_waits_for_its_arguments) {
    ResourceIndex arguments = graph.add_buffer("arguments", make_buffer("arguments")),
                  counters = graph.add_buffer("counters", make_buffer("counters"));
    uint32_t zero = 0;
    std::vector<uint32_t> seed(k_element_count, 1);
    ASSERT_TRUE(upload_now(*device, *graph.buffer(arguments), 0, std::as_bytes(std::span(seed))));
    ResourceIndex source = graph.add_buffer("source", make_buffer("source"));
    ASSERT_TRUE(upload_now(*device, *graph.buffer(source), 0, std::as_bytes(std::span(seed))));
    graph.add_pass("clear", {{counters, BufferAccess::transfer_write}}, fill(counters, &zero));
    graph.add_pass("write", {{source, BufferAccess::compute_read}, {arguments, BufferAccess::compute_write}},
                   compute(source, arguments, 2, &zero));  // 2 x 2 x 2 groups
    graph.add_pass("count",
                   {{arguments, BufferAccess::indirect_read}, {counters, BufferAccess::compute_atomic}},
                   [&](VkCommandBuffer commands) {
                       const gpu::BoundBuffer bound[] = {graph.buffer(counters)};
                       Push push{k_element_count, 1, 1};
                       count.bind(commands, bound, &push, sizeof(push));
                       count.dispatch_indirect(commands, *graph.buffer(arguments), 0);
                   });
    for (uint32_t i = 0; i < 20; i++) {
        auto frame = ring.begin();
        ASSERT_TRUE(frame);
        graph.record(frame->commands, frame->timestamps);
        ASSERT_TRUE(ring.submit());
    }
    uint32_t total = 0;
    ASSERT_TRUE(read_now(*device, *graph.buffer(counters), 0, std::as_writable_bytes(std::span(&total, 1))));
    EXPECT_EQ(total, 8 * device->limits.group_size);
}

TEST_F(Frames, a_pass_switched_off_records_nothing) {
    ResourceIndex a = graph.add_buffer("a", make_buffer("a")), b = graph.add_buffer("b", make_buffer("b"));
    uint32_t three = 3, nine = 9;
    uint32_t recorded = 0;
    graph.add_pass("three", {{a, BufferAccess::transfer_write}}, fill(a, &three));
    uint32_t nines =
        graph.add_pass("nine", {{a, BufferAccess::transfer_write}}, [&](VkCommandBuffer commands) {
            recorded++;
            fill(a, &nine)(commands);
        });
    graph.add_pass("copy", {{a, BufferAccess::transfer_read}, {b, BufferAccess::transfer_write}}, copy(a, b));
    for (bool active : {true, false, true, false}) {
        graph.set_active(nines, active);
        auto frame = ring.begin();
        ASSERT_TRUE(frame);
        graph.record(frame->commands, frame->timestamps);
        ASSERT_TRUE(ring.submit());
        uint32_t value = 0;
        ASSERT_TRUE(read_now(*device, *graph.buffer(b), 400, std::as_writable_bytes(std::span(&value, 1))));
        EXPECT_EQ(value, active ? 9u : 3u);
        EXPECT_EQ(graph.describe().find("nine: transfer write a; off") != std::string::npos, !active);
    }
    EXPECT_EQ(recorded, 2u);
}

}  // namespace
}  // namespace coppice
