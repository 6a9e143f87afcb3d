#include "runtime/gpu/buffer.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>
#include <fmt/format.h>
#include "runtime/gpu/vulkan.h"

namespace coppice::gpu {
namespace {

constexpr VkDeviceSize k_staging_bytes = VkDeviceSize(32) << 20;

struct MemoryKind {
    VkMemoryPropertyFlags required, preferred;
};

MemoryKind kind_of(MemoryUse use) {
    constexpr VkMemoryPropertyFlags k_mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    switch (use) {
        case MemoryUse::upload:
            return {k_mapped, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
        case MemoryUse::readback:
            return {k_mapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
        case MemoryUse::device:
            break;
    }
    return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
}

// Bytes of one texel of the formats a kernel here can fetch; 0: another format.
uint32_t texel_bytes(VkFormat format) {
    switch (format) {
        case VK_FORMAT_R8G8B8A8_UNORM:
        case VK_FORMAT_R8G8B8A8_UINT:
        case VK_FORMAT_R16G16_UNORM:
        case VK_FORMAT_R16G16_SNORM:
        case VK_FORMAT_R16G16_UINT:
        case VK_FORMAT_R16G16_SFLOAT:
        case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R32_SINT:
        case VK_FORMAT_R32_SFLOAT:
            return 4;
        case VK_FORMAT_R16G16B16A16_UNORM:
        case VK_FORMAT_R16G16B16A16_SNORM:
        case VK_FORMAT_R16G16B16A16_UINT:
        case VK_FORMAT_R16G16B16A16_SFLOAT:
        case VK_FORMAT_R32G32_UINT:
        case VK_FORMAT_R32G32_SFLOAT:
            return 8;
        case VK_FORMAT_R32G32B32A32_UINT:
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return 16;
        default:
            return 0;
    }
}

Status check_size(const Device& device, const BufferSettings& settings, VkDeviceSize size_bytes) {
    auto too_large = [&](VkDeviceSize limit_bytes, const char* what) {
        return fail(ErrorId::limit_exceeded, "", fmt::format("buffer \"{}\"", settings.name),
                    fmt::format("{} bytes; {} takes {} of {}", size_bytes, device.name, limit_bytes, what),
                    "draw a smaller scene or split it into more tiles");
    };
    const DeviceLimits& limits = device.limits;
    if (size_bytes > limits.buffer_bytes) return too_large(limits.buffer_bytes, "a buffer");
    if (settings.texel_format == VK_FORMAT_UNDEFINED) {
        if ((settings.usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) && size_bytes > limits.storage_range_bytes)
            return too_large(limits.storage_range_bytes, "a storage buffer");
        return {};
    }
    uint32_t bytes = texel_bytes(settings.texel_format);
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device.physical, settings.texel_format, &properties);
    if (!bytes || !(properties.bufferFeatures & VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT))
        return fail(
            ErrorId::value_out_of_range, "", fmt::format("buffer \"{}\"", settings.name),
            fmt::format("texel format {} is not one {} fetches", int(settings.texel_format), device.name),
            "use a format of 4, 8 or 16 bytes without conversion");
    VkDeviceSize limit_bytes = VkDeviceSize(limits.texel_elements) * bytes;
    if (size_bytes > limit_bytes) return too_large(limit_bytes, "a texel buffer");
    return {};
}

// Records one-off commands, submits and waits.
template <class Record>
Status run_now(const Device& device, Record record) {
    if (!device.submits())
        return fail(ErrorId::usage, "", "vkQueueSubmit", "the host keeps its queue",
                    "record a frame, or hand in a queue");
    VkCommandPool pool = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    const char* call = "vkCreateCommandPool";
    VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool_info.queueFamilyIndex = device.queue_family;
    VkResult result = vkCreateCommandPool(device.handle, &pool_info, device.allocator, &pool);
    if (result == VK_SUCCESS) {
        call = "vkCreateFence";
        VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        result = vkCreateFence(device.handle, &fence_info, device.allocator, &fence);
    }
    if (result == VK_SUCCESS) {
        call = "vkAllocateCommandBuffers";
        VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        info.commandPool = pool;
        info.commandBufferCount = 1;
        result = vkAllocateCommandBuffers(device.handle, &info, &commands);
    }
    if (result == VK_SUCCESS) {
        call = "vkBeginCommandBuffer";
        VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        result = vkBeginCommandBuffer(commands, &begin);
    }
    if (result == VK_SUCCESS) {
        // After all that was submitted before, and before all that is submitted later.
        VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        dependency.memoryBarrierCount = 1;
        dependency.pMemoryBarriers = &memory;
        memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
        memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        vkCmdPipelineBarrier2(commands, &dependency);
        record(commands);
        memory.dstStageMask |= VK_PIPELINE_STAGE_2_HOST_BIT;
        memory.dstAccessMask |= VK_ACCESS_2_HOST_READ_BIT;
        vkCmdPipelineBarrier2(commands, &dependency);
        call = "vkEndCommandBuffer";
        result = vkEndCommandBuffer(commands);
    }
    if (result == VK_SUCCESS) {
        call = "vkQueueSubmit";
        VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &commands;
        result = vkQueueSubmit(device.queue, 1, &submit, fence);
    }
    if (result == VK_SUCCESS) {
        call = "vkWaitForFences";
        result = vkWaitForFences(device.handle, 1, &fence, VK_TRUE, UINT64_MAX);
        // What is still being executed must not lose what it is executed with; of a lost device nothing is.
        if (result != VK_SUCCESS) vkQueueWaitIdle(device.queue);
    }
    vkDestroyFence(device.handle, fence, device.allocator);
    vkDestroyCommandPool(device.handle, pool, device.allocator);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, call));
    return {};
}

}  // namespace

// From the device, or from the host's own allocator.
Status Buffer::allocate(const BufferSettings& settings) {
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device_->handle, buffer_, &needs);
    const MemoryKind kind = kind_of(settings.memory);
    VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const MemorySource& source = device_->memory_source;
    if (source.allocate) {
        MemoryRange range;
        result = source.allocate(source.context, needs, kind.required, kind.preferred, range);
        if (result == VK_SUCCESS) memory_ = range;
    } else {
        // The preferred kind of memory may be full (the mappable part of a GPU's is often small): then the next.
        VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        allocate.allocationSize = needs.size;
        uint32_t types = needs.memoryTypeBits;
        while (result == VK_ERROR_OUT_OF_DEVICE_MEMORY) {
            allocate.memoryTypeIndex = device_->find_memory_type(types, kind.required, kind.preferred);
            if (allocate.memoryTypeIndex == UINT32_MAX) break;
            result = vkAllocateMemory(device_->handle, &allocate, device_->allocator, &memory_.memory);
            types &= ~(1u << allocate.memoryTypeIndex);
        }
    }
    if (result == VK_ERROR_DEVICE_LOST) return fail(vulkan_error(result, "vkAllocateMemory"));
    if (result != VK_SUCCESS)
        return fail(ErrorId::limit_exceeded, "", fmt::format("buffer \"{}\"", settings.name),
                    fmt::format("{} has no {} bytes of memory left", device_->name, size_bytes_),
                    "draw a smaller scene, lower the memory budget, or close other programs");
    result = vkBindBufferMemory(device_->handle, buffer_, memory_.memory, memory_.offset_bytes);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkBindBufferMemory"));
    if (settings.memory == MemoryUse::device) return {};
    if (!source.allocate) {
        result = vkMapMemory(device_->handle, memory_.memory, 0, VK_WHOLE_SIZE, 0, &memory_.mapped);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkMapMemory"));
    }
    if (!memory_.mapped)
        return fail(ErrorId::limit_exceeded, "", fmt::format("buffer \"{}\"", settings.name),
                    "the host's allocator did not map it",
                    "map all memory that is required to be HOST_VISIBLE");
    mapped_ = static_cast<std::byte*>(memory_.mapped);
    return {};
}

Result<Buffer> Buffer::create(const Device& device, const BufferSettings& settings) {
    Buffer buffer;
    buffer.device_ = &device;
    buffer.size_bytes_ = std::max<VkDeviceSize>(settings.size_bytes, 16);
    COPPICE_CHECK(check_size(device, settings, buffer.size_bytes_));

    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = buffer.size_bytes_;
    info.usage = settings.usage;
    if (settings.texel_format != VK_FORMAT_UNDEFINED) info.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    VkResult result = vkCreateBuffer(device.handle, &info, device.allocator, &buffer.buffer_);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateBuffer"));
    device.set_name(VK_OBJECT_TYPE_BUFFER, uint64_t(buffer.buffer_), settings.name);

    COPPICE_CHECK(buffer.allocate(settings));
    if (settings.texel_format != VK_FORMAT_UNDEFINED) {
        VkBufferViewCreateInfo view{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
        view.buffer = buffer.buffer_;
        view.format = settings.texel_format;
        view.range =
            buffer.size_bytes_ / texel_bytes(settings.texel_format) * texel_bytes(settings.texel_format);
        result = vkCreateBufferView(device.handle, &view, device.allocator, &buffer.view_);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateBufferView"));
    }
    return buffer;
}

Buffer::Buffer(Buffer&& other) noexcept { *this = std::move(other); }

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(view_, other.view_);
    std::swap(memory_, other.memory_);
    std::swap(size_bytes_, other.size_bytes_);
    std::swap(mapped_, other.mapped_);
    return *this;
}

Buffer::~Buffer() {
    if (!device_) return;
    vkDestroyBufferView(device_->handle, view_, device_->allocator);
    vkDestroyBuffer(device_->handle, buffer_, device_->allocator);
    const MemorySource& source = device_->memory_source;
    if (!source.allocate)
        vkFreeMemory(device_->handle, memory_.memory, device_->allocator);  // also unmaps
    else if (memory_.memory)
        source.release(source.context, memory_);
}

Status upload_now(const Device& device, const Buffer& target, VkDeviceSize offset,
                  std::span<const std::byte> bytes) {
    assert(offset <= target.size_bytes() && bytes.size() <= target.size_bytes() - offset &&
           "upload past the end");
    if (bytes.empty()) return {};
    if (target.mapped()) {
        if (!device.submits())
            return fail(ErrorId::usage, "", "vkQueueWaitIdle", "the host keeps its queue",
                        "write into the mapped buffer when no frame uses it");
        VkResult result = vkQueueWaitIdle(device.queue);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkQueueWaitIdle"));
        std::memcpy(target.mapped() + offset, bytes.data(), bytes.size());
        return {};
    }
    BufferSettings settings;
    settings.size_bytes = std::min<VkDeviceSize>(bytes.size(), k_staging_bytes);
    settings.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    settings.memory = MemoryUse::upload;
    settings.name = "staging";
    COPPICE_TRY(Buffer staging, Buffer::create(device, settings));
    for (VkDeviceSize done = 0; done < bytes.size(); done += k_staging_bytes) {
        VkDeviceSize count = std::min<VkDeviceSize>(bytes.size() - done, k_staging_bytes);
        std::memcpy(staging.mapped(), bytes.data() + done, count);
        VkBufferCopy region{0, offset + done, count};
        COPPICE_CHECK(run_now(device, [&](VkCommandBuffer commands) {
            vkCmdCopyBuffer(commands, staging.handle(), target.handle(), 1, &region);
        }));
    }
    return {};
}

Status read_now(const Device& device, const Buffer& source, VkDeviceSize offset, std::span<std::byte> bytes) {
    assert(offset <= source.size_bytes() && bytes.size() <= source.size_bytes() - offset &&
           "read past the end");
    if (bytes.empty()) return {};
    BufferSettings settings;
    settings.size_bytes = std::min<VkDeviceSize>(bytes.size(), k_staging_bytes);
    settings.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    settings.memory = MemoryUse::readback;
    settings.name = "staging";
    COPPICE_TRY(Buffer staging, Buffer::create(device, settings));
    for (VkDeviceSize done = 0; done < bytes.size(); done += k_staging_bytes) {
        VkDeviceSize count = std::min<VkDeviceSize>(bytes.size() - done, k_staging_bytes);
        VkBufferCopy region{offset + done, 0, count};
        COPPICE_CHECK(run_now(device, [&](VkCommandBuffer commands) {
            vkCmdCopyBuffer(commands, source.handle(), staging.handle(), 1, &region);
        }));
        std::memcpy(bytes.data() + done, staging.mapped(), count);
    }
    return {};
}

}  // namespace coppice::gpu
