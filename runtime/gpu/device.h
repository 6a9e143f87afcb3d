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
#include "runtime/gpu/vulkan.h"

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

// What a host hands in. The device must have been made with the extension VK_KHR_push_descriptor and the
// features that Device::create names. The queue belongs to Coppice while it draws; nothing here is destroyed
// by it.
struct HostDevice {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t queue_family;
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
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
    DeviceLimits limits{};
    std::string name;    // "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string driver;  // name and version
    uint64_t validation_messages() const { return validation_messages_; }  // warnings and errors so far

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
