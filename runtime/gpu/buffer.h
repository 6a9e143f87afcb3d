// A buffer with memory of its own.
#pragma once
#include <span>
#include "runtime/gpu/device.h"

namespace coppice::gpu {

enum class MemoryUse {
    device,    // only the device touches it
    upload,    // written by the CPU each frame through `mapped`, in device memory where that is possible
    readback,  // read by the CPU through `mapped`, cached
};

struct BufferSettings {
    VkDeviceSize size_bytes = 0;  // 0 is taken as 16: Vulkan knows no empty buffer
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                               VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    MemoryUse memory = MemoryUse::device;
    VkFormat texel_format =
        VK_FORMAT_UNDEFINED;  // else also a uniform texel buffer of this format, over the whole
    const char* name = "";
};

class Buffer {
  public:
    // Errors: limit_exceeded (too large, or no memory of the kind), device_lost.
    static Result<Buffer> create(const Device& device, const BufferSettings& settings);
    Buffer() = default;
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();

    VkBuffer handle() const { return buffer_; }
    VkBufferView texel_view() const { return view_; }
    VkDeviceSize size_bytes() const { return size_bytes_; }
    // nullptr for MemoryUse::device. Coherent.
    std::byte* mapped() const { return mapped_; }
    template <class T>
    std::span<T> mapped_as() const {
        return {reinterpret_cast<T*>(mapped_), mapped_ ? size_t(size_bytes_ / sizeof(T)) : 0};
    }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

  private:
    Status allocate(const BufferSettings& settings);
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkBufferView view_ = VK_NULL_HANDLE;
    MemoryRange memory_;
    VkDeviceSize size_bytes_ = 0;
    std::byte* mapped_ = nullptr;
};

// Copies bytes into a buffer through a staging buffer and waits. For loading, not for frames.
// Requires offset + bytes <= size. Errors: usage where the host keeps its queue; limit_exceeded, device_lost.
Status upload_now(const Device& device, const Buffer& target, VkDeviceSize offset,
                  std::span<const std::byte> bytes);
// The other way round.
Status read_now(const Device& device, const Buffer& source, VkDeviceSize offset, std::span<std::byte> bytes);

}  // namespace coppice::gpu
