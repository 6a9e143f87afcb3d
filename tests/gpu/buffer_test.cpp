#include "runtime/gpu/buffer.h"

#include <cstring>
#include <vector>
#include "tests/gpu/validated_device.h"

namespace coppice::gpu {
namespace {

using Buffers = ValidatedDevice;

std::vector<std::byte> pattern(size_t count, uint32_t seed) {
    std::vector<std::byte> bytes(count);
    for (size_t i = 0; i < count; i++) bytes[i] = std::byte(((i * 2654435761u) >> 13) + seed);
    return bytes;
}

TEST_F(Buffers, keep_what_is_uploaded) {
    for (MemoryUse memory : {MemoryUse::device, MemoryUse::upload, MemoryUse::readback}) {
        auto buffer = Buffer::create(*device, {.size_bytes = 1000, .memory = memory, .name = "round trip"});
        ASSERT_TRUE(buffer) << to_string(buffer.error());
        EXPECT_EQ(buffer->mapped() != nullptr, memory != MemoryUse::device);
        std::vector<std::byte> all = pattern(1000, 1), part = pattern(100, 77), read(1000);
        ASSERT_TRUE(upload_now(*device, *buffer, 0, all));
        ASSERT_TRUE(upload_now(*device, *buffer, 444, part));
        std::memcpy(all.data() + 444, part.data(), part.size());
        ASSERT_TRUE(read_now(*device, *buffer, 0, read));
        EXPECT_EQ(read, all);
        std::vector<std::byte> middle(96);
        ASSERT_TRUE(read_now(*device, *buffer, 448, middle));
        EXPECT_EQ(std::memcmp(middle.data(), all.data() + 448, middle.size()), 0);
    }
}

TEST_F(Buffers, larger_than_the_staging_buffer_keep_what_is_uploaded) {
    size_t size_bytes = (size_t(70) << 20) + 12;
    auto buffer = Buffer::create(*device, {.size_bytes = size_bytes});
    ASSERT_TRUE(buffer) << to_string(buffer.error());
    std::vector<std::byte> written = pattern(size_bytes, 3), read(size_bytes);
    ASSERT_TRUE(upload_now(*device, *buffer, 0, written));
    ASSERT_TRUE(read_now(*device, *buffer, 0, read));
    EXPECT_TRUE(read == written);
}

TEST_F(Buffers, of_no_size_exist) {
    auto buffer = Buffer::create(*device, {.size_bytes = 0, .memory = MemoryUse::upload});
    ASSERT_TRUE(buffer);
    EXPECT_TRUE(*buffer);
    EXPECT_EQ(buffer->size_bytes(), 16u);
    EXPECT_EQ(buffer->mapped_as<uint32_t>().size(), 4u);
    EXPECT_TRUE(upload_now(*device, *buffer, 16, {}));
}

TEST_F(Buffers, move) {
    auto buffer = Buffer::create(*device, {.size_bytes = 64});
    ASSERT_TRUE(buffer);
    VkBuffer handle = buffer->handle();
    Buffer moved = std::move(*buffer);
    EXPECT_EQ(moved.handle(), handle);
    Buffer assigned;
    EXPECT_FALSE(assigned);
    assigned = std::move(moved);
    EXPECT_EQ(assigned.handle(), handle);
    EXPECT_EQ(assigned.size_bytes(), 64u);
}

TEST_F(Buffers, too_large_are_refused_with_the_limit) {
    struct Case {
        BufferSettings settings;
        VkDeviceSize limit_bytes;
    };
    const DeviceLimits& limits = device->limits;
    std::vector<Case> cases{
        {{.size_bytes = limits.storage_range_bytes + 16, .name = "big"}, limits.storage_range_bytes}};
    if (VkDeviceSize(limits.texel_elements) * 4 + 16 < limits.buffer_bytes)
        cases.push_back({{.size_bytes = VkDeviceSize(limits.texel_elements) * 4 + 16,
                          .texel_format = VK_FORMAT_R32_UINT,
                          .name = "big"},
                         VkDeviceSize(limits.texel_elements) * 4});
    cases.push_back(
        {{.size_bytes = limits.buffer_bytes + 1, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT, .name = "big"},
         limits.buffer_bytes});
    for (const Case& c : cases) {
        if (c.settings.size_bytes < 16 || c.settings.size_bytes < c.limit_bytes)
            continue;  // no limit to pass
        auto buffer = Buffer::create(*device, c.settings);
        ASSERT_FALSE(buffer) << c.settings.size_bytes;
        EXPECT_EQ(buffer.error().id, ErrorId::limit_exceeded);
        EXPECT_NE(buffer.error().place.find("big"), std::string::npos);
    }
}

TEST_F(Buffers, texel_formats_that_cannot_be_fetched_are_refused) {
    auto buffer = Buffer::create(*device, {.size_bytes = 64, .texel_format = VK_FORMAT_D32_SFLOAT_S8_UINT});
    ASSERT_FALSE(buffer);
    EXPECT_EQ(buffer.error().id, ErrorId::value_out_of_range);
}

}  // namespace
}  // namespace coppice::gpu
