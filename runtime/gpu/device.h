// One Vulkan 1.3 device with one queue for compute and transfer, headless. Loaded at run time by volk;
// programs run (and say so) on machines without Vulkan. A host may hand in its own instance, device and
// queue.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include "runtime/core/result.h"
#include "runtime/gpu/vulkan_types.h"

namespace coppice::gpu {

struct DeviceSettings {
    std::string choice;  // index ("0") or part of a device's name, any case; empty: discrete, integrated, CPU
    bool validation =
        false;  // validation layer with synchronisation validation; messages are counted and logged
    bool present = false;  // swapchain extension and the surface extensions named below
    std::vector<const char*> instance_extensions;
};

struct DeviceLimits {
    uint32_t subgroup_size;
    uint32_t group_size;  // lanes a work group should have: 8 on a CPU device, else 64 (MEASURED: Lavapipe)
    VkDeviceSize buffer_bytes;         // of one buffer
    VkDeviceSize storage_range_bytes;  // of one storage binding
    uint32_t texel_elements;           // of one texel buffer
    uint32_t groups_per_axis;
    uint32_t bindings;  // of one kernel
    uint32_t push_constant_bytes;
    uint32_t timestamp_bits;
    double timestamp_ns;  // one tick; 0: no timestamps
    bool is_cpu;
};

// A buffer's memory, as a host's allocator gives it.
struct MemoryRange {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset_bytes = 0;
    void* mapped = nullptr;  // of the range's first byte, where `required` has HOST_VISIBLE; stays mapped
    void* own = nullptr;     // the allocator's
};

// In place of vkAllocateMemory; called by whoever makes or destroys a buffer. Ranges must fit `needs` and have all flags
// `required`, where possible also those `preferred`. A failure is a VkResult; VK_ERROR_OUT_OF_DEVICE_MEMORY becomes
// limit_exceeded.
struct MemorySource {
    void* context = nullptr;
    VkResult (*allocate)(void* context, const VkMemoryRequirements& needs, VkMemoryPropertyFlags required,
                         VkMemoryPropertyFlags preferred, MemoryRange& range) = nullptr;
    void (*release)(void* context, const MemoryRange& range) = nullptr;
};

// What a host hands in. The device must have been made with the extension VK_KHR_push_descriptor and the
// features that Device::create names; nothing here is destroyed. With a queue, loading submits to it and waits for the
// device, and nobody else may use it meanwhile. Without one nothing is ever submitted or waited for: what is loaded is
// copied by the commands of the next frame recorded, upload_now and read_now are errors, and whatever was made
// is destroyed by the host's word that the device has finished with it.
struct HostDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;                         // of the queue that frames are submitted to
    MemorySource memory;                               // no allocate: a vkAllocateMemory for each buffer
    const VkAllocationCallbacks* allocator = nullptr;  // of all objects; outlives the device
};

// One thread at a time.
class Device {
  public:
    // Needs Vulkan 1.3, a compute queue, 64-bit integers and buffer atomics, scalar block layout, push
    // descriptors, synchronization2, timeline semaphores. device_missing names what each device lacks;
    // name_unknown: no device of that choice. One warning on a CPU device.
    static Result<std::unique_ptr<Device>> create(const DeviceSettings& settings);
    static Result<std::unique_ptr<Device>> adopt(const HostDevice& host);
    ~Device();  // waits until the device is idle
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice handle = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;  // none: the host keeps its own
    uint32_t queue_family = 0;
    MemorySource memory_source;                        // none: vkAllocateMemory
    const VkAllocationCallbacks* allocator = nullptr;  // of all objects made on the device
    DeviceLimits limits{};
    std::string name;    // "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string driver;  // name and version
    uint64_t validation_messages() const { return validation_messages_; }  // warnings and errors so far

    // Whether work may be submitted and waited for here: false where the host keeps its queue.
    bool submits() const { return queue != VK_NULL_HANDLE; }
    // Until the device has finished all there is; nothing where the host keeps its queue.
    void wait_idle() const;

    // Index of a memory type among `type_bits` with all `required` flags, preferring `preferred`; UINT32_MAX:
    // none.
    uint32_t find_memory_type(uint32_t type_bits, VkMemoryPropertyFlags required,
                              VkMemoryPropertyFlags preferred) const;
    // For messages of the validation layer; nothing without it.
    void set_name(VkObjectType type, uint64_t object, const char* name) const;

  private:
    Device() = default;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    std::atomic<uint64_t> validation_messages_{0};
    VkPhysicalDeviceMemoryProperties memory_{};
    bool validated_ = false;
    bool owned_ = false;  // false: the host's
    friend struct DeviceMaker;
};

// Name and type of every device, for `--device` listings. Empty where there is no Vulkan.
std::vector<std::string> list_devices();

// A VkResult as an Error: device_lost, limit_exceeded (memory), or value_out_of_range for the rest, naming
// the call.
Error vulkan_error(VkResult result, const char* call);

}  // namespace coppice::gpu
