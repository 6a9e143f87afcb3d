#include "runtime/gpu/device.h"

#include <cstdlib>
#include <string>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/log.h"
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/vulkan.h"

namespace coppice::gpu {
namespace {

// Collects what is logged while it lives.
struct Log {
    Log() {
        set_log_sink(
            [](void* self, LogLevel level, std::string_view line) {
                static_cast<Log*>(self)->lines.push_back({level, std::string(line)});
            },
            this);
    }
    ~Log() { set_log_sink(nullptr, nullptr); }
    struct Line {
        LogLevel level;
        std::string text;
    };
    std::vector<Line> lines;
};

TEST(device, names_itself_and_its_limits) {
    auto device = Device::create({});
    ASSERT_TRUE(device) << to_string(device.error());
    EXPECT_FALSE((*device)->name.empty());
    EXPECT_FALSE((*device)->driver.empty());
    const DeviceLimits& limits = (*device)->limits;
    EXPECT_GE(limits.storage_range_bytes, VkDeviceSize(1) << 27);
    EXPECT_GE(limits.groups_per_axis, 65535u);
    EXPECT_GE(limits.bindings, 32u);
    EXPECT_GE(limits.push_constant_bytes, 128u);
    EXPECT_EQ(limits.group_size, limits.is_cpu ? 8u : 64u);
    EXPECT_GT(limits.timestamp_ns, 0.0);
    EXPECT_EQ((*device)->validation_messages(), 0u);
}

TEST(device, warns_once_on_a_cpu) {
    Log log;
    auto device = Device::create({});
    ASSERT_TRUE(device) << to_string(device.error());
    size_t warning_count = 0;
    for (const Log::Line& line : log.lines) warning_count += line.level != LogLevel::note;
    EXPECT_EQ(warning_count, (*device)->limits.is_cpu ? 1u : 0u);
}

TEST(device, is_chosen_by_index_or_part_of_its_name) {
    std::vector<std::string> listed = list_devices();
    ASSERT_FALSE(listed.empty());
    EXPECT_EQ(listed[0].substr(0, 3), "0: ");
    auto first = Device::create({.choice = "0"});
    ASSERT_TRUE(first) << to_string(first.error());
    EXPECT_NE(listed[0].find((*first)->name), std::string::npos);

    std::string part = (*first)->name.substr(1, 5);
    for (char& c : part)
        if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
    auto named = Device::create({.choice = part});
    ASSERT_TRUE(named) << to_string(named.error());
    EXPECT_EQ((*named)->name, (*first)->name);
}

TEST(device, unknown_choice_names_the_choices) {
    for (const char* choice : {"no such device", "99", "00"}) {
        auto device = Device::create({.choice = choice});
        ASSERT_FALSE(device) << choice;
        EXPECT_EQ(device.error().id, ErrorId::name_unknown);
        EXPECT_NE(device.error().fault.find(choice), std::string::npos);
        EXPECT_NE(device.error().remedy.find(list_devices()[0]), std::string::npos) << device.error().remedy;
    }
}

TEST(device, missing_instance_extension_is_a_missing_device) {
    DeviceSettings settings;
    settings.instance_extensions = {"VK_KHR_no_such_extension"};
    auto device = Device::create(settings);
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().id, ErrorId::device_missing);
    EXPECT_NE(device.error().fault.find("VK_KHR_no_such_extension"), std::string::npos);
    EXPECT_EQ(exit_code_of(device.error().id), 3);
}

TEST(device, no_driver_is_a_missing_device_with_the_remedy) {
    // The loader reads the driver list when an instance is made.
    setenv("VK_ICD_FILENAMES", "/nonexistent/driver.json", 1);
    auto device = Device::create({});
    std::vector<std::string> listed = list_devices();
    unsetenv("VK_ICD_FILENAMES");
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().id, ErrorId::device_missing);
    EXPECT_NE(device.error().remedy.find("mesa-vulkan-drivers"), std::string::npos);
    EXPECT_TRUE(listed.empty());
}

TEST(device, validation_counts_and_logs_mistakes) {
    DeviceSettings settings;
    settings.validation = true;
    auto device = Device::create(settings);
    ASSERT_TRUE(device) << to_string(device.error());
    EXPECT_EQ((*device)->validation_messages(), 0u);
    Log log;
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = 0;  // not allowed
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    VkBuffer buffer = VK_NULL_HANDLE;
    if (vkCreateBuffer((*device)->handle, &info, nullptr, &buffer) == VK_SUCCESS)
        vkDestroyBuffer((*device)->handle, buffer, nullptr);
    EXPECT_EQ((*device)->validation_messages(), 1u);
    ASSERT_FALSE(log.lines.empty());
    EXPECT_NE(log.lines[0].text.find("VUID-VkBufferCreateInfo-size-00912"), std::string::npos)
        << log.lines[0].text;
}

TEST(device, two_live_side_by_side_and_outlive_a_listing) {
    auto plain = Device::create({});
    ASSERT_TRUE(plain);
    DeviceSettings settings;
    settings.validation = true;
    auto validated = Device::create(settings);
    ASSERT_TRUE(validated);
    ASSERT_FALSE(list_devices().empty());
    for (Device* device : {plain->get(), validated->get()}) {
        auto buffer = Buffer::create(*device, {.size_bytes = 64, .name = "named"});
        ASSERT_TRUE(buffer);
        std::vector<std::byte> written(64, std::byte{5}), read(64);
        ASSERT_TRUE(upload_now(*device, *buffer, 0, written));
        ASSERT_TRUE(read_now(*device, *buffer, 0, read));
        EXPECT_EQ(written, read);
    }
    plain->reset();
    EXPECT_EQ((*validated)->validation_messages(), 0u);
}

TEST(device, of_a_host_is_used_and_left_alive) {
    DeviceSettings settings;
    settings.validation = true;
    auto host = Device::create(settings);
    ASSERT_TRUE(host);
    {
        auto adopted = Device::adopt(
            {(*host)->instance, (*host)->physical, (*host)->handle, (*host)->queue, (*host)->queue_family});
        ASSERT_TRUE(adopted) << to_string(adopted.error());
        EXPECT_EQ((*adopted)->name, (*host)->name);
        auto buffer = Buffer::create(**adopted, {.size_bytes = 64});
        ASSERT_TRUE(buffer);
        std::vector<std::byte> written(64, std::byte{9}), read(64);
        ASSERT_TRUE(upload_now(**adopted, *buffer, 0, written));
        ASSERT_TRUE(read_now(**adopted, *buffer, 0, read));
        EXPECT_EQ(written, read);
    }
    EXPECT_EQ(vkDeviceWaitIdle((*host)->handle), VK_SUCCESS);
    EXPECT_EQ((*host)->validation_messages(), 0u);
}

TEST(device, results_become_errors) {
    EXPECT_EQ(vulkan_error(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2").id, ErrorId::device_lost);
    EXPECT_EQ(vulkan_error(VK_ERROR_OUT_OF_DEVICE_MEMORY, "x").id, ErrorId::limit_exceeded);
    Error other = vulkan_error(VK_ERROR_FORMAT_NOT_SUPPORTED, "vkCreateBufferView");
    EXPECT_EQ(other.id, ErrorId::value_out_of_range);
    EXPECT_EQ(other.place, "vkCreateBufferView");
    EXPECT_NE(other.fault.find("-11"), std::string::npos);
}

}  // namespace
}  // namespace coppice::gpu
