#define VOLK_IMPLEMENTATION
#define VOLK_DEFAULT_VISIBILITY
#include "runtime/gpu/device.h"
#include "runtime/gpu/vulkan.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>
#include <string_view>

#include "runtime/core/log.h"

namespace coppice::gpu {
namespace {

constexpr const char* k_validation_layer = "VK_LAYER_KHRONOS_validation";
constexpr const char* k_driver_remedy =
    "install a Vulkan 1.3 driver (without a GPU: the Debian package mesa-vulkan-drivers)";

// volk's pointers are one set for the process; all of them lead through the loader, which finds the right
// device.
std::mutex g_volk_mutex;

// What a kernel of this project may use. The mandatory ones are checked by name in `lacks_of`.
struct Features {
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &v13};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, &v12};
    VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v11};
    Features() = default;
    Features(const Features&) = delete;
};

struct Candidate {
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties{};
    std::optional<uint32_t> queue_family;
    std::string lacks;  // empty: usable
};

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

int preference_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return 4;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return 3;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return 2;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return 1;
        default:
            return 0;
    }
}

bool has_extension(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
    return std::any_of(extensions.begin(), extensions.end(),
                       [name](const VkExtensionProperties& e) { return name == e.extensionName; });
}

std::vector<VkExtensionProperties> instance_extensions(const char* layer) {
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(layer, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data());
    extensions.resize(count);
    return extensions;
}

std::vector<VkExtensionProperties> device_extensions(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    extensions.resize(count);
    return extensions;
}

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    return families;
}

// A family that also draws is preferred: it can present, and blit into a swapchain.
std::optional<uint32_t> find_queue_family(VkPhysicalDevice physical) {
    std::vector<VkQueueFamilyProperties> families = queue_families(physical);
    for (VkQueueFlags flags : {VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT, VK_QUEUE_COMPUTE_BIT + 0})
        for (uint32_t i = 0; i < families.size(); i++)
            if ((families[i].queueFlags & flags) == flags) return i;
    return std::nullopt;
}

Candidate examine(VkPhysicalDevice physical, bool present) {
    Candidate candidate{physical};
    vkGetPhysicalDeviceProperties(physical, &candidate.properties);
    auto lack = [&candidate](bool there, const char* what) {
        if (there) return;
        if (!candidate.lacks.empty()) candidate.lacks += ", ";
        candidate.lacks += what;
    };
    lack(candidate.properties.apiVersion >= VK_API_VERSION_1_3, "Vulkan 1.3");
    if (!candidate.lacks.empty()) return candidate;  // the structures below need it

    Features has;
    vkGetPhysicalDeviceFeatures2(physical, &has.all);
    lack(has.all.features.shaderInt64, "shaderInt64");
    lack(has.v12.shaderBufferInt64Atomics, "shaderBufferInt64Atomics");
    lack(has.v12.timelineSemaphore, "timelineSemaphore");
    lack(has.v12.scalarBlockLayout, "scalarBlockLayout");
    lack(has.v13.synchronization2, "synchronization2");
    VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    lack(v11.subgroupSupportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_RELATIVE_BIT, "subgroup shuffles");
    std::vector<VkExtensionProperties> extensions = device_extensions(physical);
    lack(has_extension(extensions, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME),
         VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    if (present)
        lack(has_extension(extensions, VK_KHR_SWAPCHAIN_EXTENSION_NAME), VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    candidate.queue_family = find_queue_family(physical);
    lack(candidate.queue_family.has_value(), "a compute queue");
    return candidate;
}

// Vulkan returns devices in no stated order, but the same one within a process.
Result<std::vector<Candidate>> list_candidates(VkInstance instance, bool present) {
    uint32_t count = 0;
    VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    if (result == VK_SUCCESS) result = vkEnumeratePhysicalDevices(instance, &count, devices.data());
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return fail(ErrorId::device_missing, "", "vkEnumeratePhysicalDevices", "no device could be listed",
                    k_driver_remedy);
    devices.resize(count);
    std::vector<Candidate> candidates;
    for (VkPhysicalDevice device : devices) candidates.push_back(examine(device, present));
    return candidates;
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return result;
}

std::string describe(size_t index, const Candidate& candidate) {
    std::string line = fmt::format("{}: {} ({})", index, candidate.properties.deviceName,
                                   type_name(candidate.properties.deviceType));
    if (!candidate.lacks.empty()) line += ", lacks " + candidate.lacks;
    return line;
}

std::string describe_all(const std::vector<Candidate>& candidates) {
    std::string text;
    for (size_t i = 0; i < candidates.size(); i++) text += (i ? "; " : "") + describe(i, candidates[i]);
    return text;
}

Result<Candidate> choose(const std::vector<Candidate>& candidates, const std::string& choice) {
    if (candidates.empty())
        return fail(ErrorId::device_missing, "", "", "there is no Vulkan device", k_driver_remedy);
    const Candidate* best = nullptr;
    if (choice.empty()) {
        for (const Candidate& c : candidates)
            if (c.lacks.empty() && (!best || preference_of(c.properties.deviceType) >
                                                 preference_of(best->properties.deviceType)))
                best = &c;
        if (!best)
            return fail(ErrorId::device_missing, "", "", "no device can be used: " + describe_all(candidates),
                        k_driver_remedy);
        return *best;
    }
    bool number = std::all_of(choice.begin(), choice.end(), [](char c) { return c >= '0' && c <= '9'; });
    for (size_t i = 0; i < candidates.size(); i++) {
        bool named =
            number ? choice == std::to_string(i)
                   : lower(candidates[i].properties.deviceName).find(lower(choice)) != std::string::npos;
        if (named && (!best || !best->lacks.empty())) best = &candidates[i];
    }
    if (!best)
        return fail(ErrorId::name_unknown, "", "", fmt::format("there is no device \"{}\"", choice),
                    "name one of " + describe_all(candidates));
    if (!best->lacks.empty())
        return fail(ErrorId::device_missing, "", "",
                    fmt::format("device \"{}\" lacks {}", best->properties.deviceName, best->lacks),
                    "choose another device, or update its driver");
    return *best;
}

bool start_volk() {
    std::lock_guard lock(g_volk_mutex);
    return vkCreateInstance || volkInitialize() == VK_SUCCESS;
}

void load_functions(VkInstance instance) {
    std::lock_guard lock(g_volk_mutex);
    volkLoadInstance(instance);
}

tl::unexpected<Error> no_vulkan(const char* place, const char* fault) {
    return fail(ErrorId::device_missing, "", place, fault, k_driver_remedy);
}

}  // namespace

// The steps of making a device, each leaving what it made in the device, whose destructor frees it.
struct DeviceMaker {
    static VKAPI_ATTR VkBool32 VKAPI_CALL count_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                        VkDebugUtilsMessageTypeFlagsEXT,
                                                        const VkDebugUtilsMessengerCallbackDataEXT* message,
                                                        void* device) {
        static_cast<Device*>(device)->validation_messages_++;
        const char* id = message->pMessageIdName ? message->pMessageIdName : "no id";
        LogLevel level =
            severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT ? LogLevel::error : LogLevel::warning;
        log_line(level, fmt::format("validation [{}]: {}", id, message->pMessage));
        return VK_FALSE;
    }

    static Status make_instance(Device& device, const DeviceSettings& settings) {
        if (!start_volk()) return no_vulkan("libvulkan.so.1", "the Vulkan loader is not installed");
        if (volkGetInstanceVersion() < VK_API_VERSION_1_3)
            return no_vulkan("", "the Vulkan loader is older than 1.3");

        std::vector<VkExtensionProperties> offered = instance_extensions(nullptr);
        std::vector<const char*> extensions = settings.instance_extensions;
        auto add = [&](const char* name) {
            auto same = [name](const char* e) { return std::strcmp(e, name) == 0; };
            if (std::none_of(extensions.begin(), extensions.end(), same)) extensions.push_back(name);
        };
        // The loader hands out the pointers of an extension only to instances that have it, and the pointers
        // are shared by the process: so every instance has both.
        for (const char* name : {VK_KHR_SURFACE_EXTENSION_NAME, VK_EXT_DEBUG_UTILS_EXTENSION_NAME})
            if (has_extension(offered, name)) add(name);
        for (const char* name : extensions)
            if (!has_extension(offered, name))
                return fail(ErrorId::device_missing, "", "vkCreateInstance",
                            fmt::format("the instance extension {} is missing", name),
                            "install a driver that can present, or run without a window");

        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
        application.pApplicationName = "coppice";
        application.pEngineName = "coppice";
        application.apiVersion = VK_API_VERSION_1_3;
        VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        info.pApplicationInfo = &application;
        info.enabledExtensionCount = uint32_t(extensions.size());
        info.ppEnabledExtensionNames = extensions.data();

        VkValidationFeatureEnableEXT synchronization =
            VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
        VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = &synchronization;
        VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                                     &features};
        messenger.messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        messenger.messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        messenger.pfnUserCallback = count_message;
        messenger.pUserData = &device;
        if (settings.validation) {
            uint32_t count = 0;
            vkEnumerateInstanceLayerProperties(&count, nullptr);
            std::vector<VkLayerProperties> layers(count);
            vkEnumerateInstanceLayerProperties(&count, layers.data());
            layers.resize(count);
            if (std::none_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
                    return std::strcmp(layer.layerName, k_validation_layer) == 0;
                }))
                return fail(ErrorId::device_missing, "", "",
                            fmt::format("{} is not installed", k_validation_layer),
                            "install the Debian package vulkan-validationlayers, or run without validation");
            info.enabledLayerCount = 1;
            info.ppEnabledLayerNames = &k_validation_layer;
            info.pNext = &messenger;  // also covers the making and the end of the instance
        }

        VkResult result = vkCreateInstance(&info, nullptr, &device.instance);
        if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
            return no_vulkan("vkCreateInstance", "no Vulkan driver is installed");
        if (result != VK_SUCCESS) return no_vulkan("vkCreateInstance", "Vulkan does not start");
        load_functions(device.instance);
        device.validated_ = settings.validation;
        if (settings.validation) {
            messenger.pNext = nullptr;
            result = vkCreateDebugUtilsMessengerEXT(device.instance, &messenger, nullptr, &device.messenger_);
            if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateDebugUtilsMessengerEXT"));
        }
        return {};
    }

    static Status make_device(Device& device, const Candidate& candidate, bool present) {
        Features has;
        vkGetPhysicalDeviceFeatures2(candidate.physical, &has.all);
        Features use;
        use.all.features.shaderInt64 = VK_TRUE;
        use.all.features.shaderInt16 = has.all.features.shaderInt16;
        use.v11.storageBuffer16BitAccess = has.v11.storageBuffer16BitAccess;
        use.v12.storageBuffer8BitAccess = has.v12.storageBuffer8BitAccess;
        use.v12.shaderInt8 = has.v12.shaderInt8;
        use.v12.shaderFloat16 = has.v12.shaderFloat16;
        use.v12.shaderBufferInt64Atomics = VK_TRUE;
        use.v12.shaderSharedInt64Atomics = has.v12.shaderSharedInt64Atomics;
        use.v12.scalarBlockLayout = VK_TRUE;
        use.v12.timelineSemaphore = VK_TRUE;
        use.v13.synchronization2 = VK_TRUE;
        use.v13.maintenance4 = has.v13.maintenance4;  // group sizes by specialisation constant
        use.v13.subgroupSizeControl = has.v13.subgroupSizeControl;
        use.v13.computeFullSubgroups = has.v13.computeFullSubgroups;

        std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
        if (present) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        float priority = 1.0f;
        VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
        queue.queueFamilyIndex = *candidate.queue_family;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
        VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &use.all};
        info.queueCreateInfoCount = 1;
        info.pQueueCreateInfos = &queue;
        info.enabledExtensionCount = uint32_t(extensions.size());
        info.ppEnabledExtensionNames = extensions.data();
        VkResult result = vkCreateDevice(candidate.physical, &info, nullptr, &device.handle);
        if (result == VK_ERROR_DEVICE_LOST) return fail(vulkan_error(result, "vkCreateDevice"));
        if (result != VK_SUCCESS)
            return fail(ErrorId::device_missing, "", "vkCreateDevice",
                        fmt::format("device \"{}\" does not start (VkResult {})",
                                    candidate.properties.deviceName, int(result)),
                        "end other programs that use it, or choose another device");
        device.owned_ = true;
        vkGetDeviceQueue(device.handle, *candidate.queue_family, 0, &device.queue);
        return {};
    }

    static std::vector<std::string> list() {
        std::vector<std::string> lines;
        Device device;
        if (!make_instance(device, {})) return lines;
        if (auto candidates = list_candidates(device.instance, false))
            for (size_t i = 0; i < candidates->size(); i++) lines.push_back(describe(i, (*candidates)[i]));
        return lines;
    }

    static void describe_device(Device& device, const Candidate& candidate) {
        device.physical = candidate.physical;
        device.queue_family = *candidate.queue_family;
        device.name = candidate.properties.deviceName;
        vkGetPhysicalDeviceMemoryProperties(device.physical, &device.memory_);

        VkPhysicalDeviceVulkan13Properties v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
        VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES, &v13};
        VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &v12};
        VkPhysicalDevicePushDescriptorPropertiesKHR push{
            VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR, &v11};
        VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &push};
        vkGetPhysicalDeviceProperties2(device.physical, &all);
        device.driver = fmt::format("{} {}", v12.driverName, v12.driverInfo);

        const VkPhysicalDeviceLimits& has = all.properties.limits;
        uint32_t timestamp_bits = queue_families(device.physical)[device.queue_family].timestampValidBits;
        DeviceLimits& limits = device.limits;
        limits.is_cpu = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        limits.subgroup_size = v11.subgroupSize;
        limits.group_size = limits.is_cpu ? 8 : 64;
        limits.buffer_bytes = std::min(v13.maxBufferSize, v11.maxMemoryAllocationSize);
        limits.storage_range_bytes = has.maxStorageBufferRange;
        limits.texel_elements = has.maxTexelBufferElements;
        limits.groups_per_axis = std::min(has.maxComputeWorkGroupCount[0], has.maxComputeWorkGroupCount[1]);
        limits.bindings = push.maxPushDescriptors;
        limits.push_constant_bytes = has.maxPushConstantsSize;
        limits.timestamp_bits = timestamp_bits;
        limits.timestamp_ns = timestamp_bits ? double(has.timestampPeriod) : 0.0;
        if (limits.is_cpu)
            log_warning("drawing on the CPU ({}): expect a fraction of a GPU's speed", device.name);
    }
};

Result<std::unique_ptr<Device>> Device::create(const DeviceSettings& settings) {
    std::unique_ptr<Device> device(new Device);
    COPPICE_CHECK(DeviceMaker::make_instance(*device, settings));
    COPPICE_TRY(std::vector<Candidate> candidates, list_candidates(device->instance, settings.present));
    COPPICE_TRY(Candidate candidate, choose(candidates, settings.choice));
    COPPICE_CHECK(DeviceMaker::make_device(*device, candidate, settings.present));
    DeviceMaker::describe_device(*device, candidate);
    return device;
}

Result<std::unique_ptr<Device>> Device::adopt(const HostDevice& host) {
    if (!start_volk()) return no_vulkan("libvulkan.so.1", "the Vulkan loader is not installed");
    load_functions(host.instance);
    Candidate candidate = examine(host.physical, false);
    if (!candidate.lacks.empty())
        return fail(ErrorId::device_missing, "", "",
                    fmt::format("device \"{}\" lacks {}", candidate.properties.deviceName, candidate.lacks),
                    "hand in another device");
    std::unique_ptr<Device> device(new Device);
    device->instance = host.instance;
    device->handle = host.device;
    device->queue = host.queue;
    device->memory_source = host.memory;
    device->allocator = host.allocator;
    candidate.queue_family = host.queue_family;
    DeviceMaker::describe_device(*device, candidate);
    return device;
}

Device::~Device() {
    if (!owned_ && handle) return;  // the host's
    if (handle) {
        vkDeviceWaitIdle(handle);
        vkDestroyDevice(handle, nullptr);
    }
    if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
    if (instance) vkDestroyInstance(instance, nullptr);
}

void Device::wait_idle() const {
    if (submits()) vkDeviceWaitIdle(handle);
}

uint32_t Device::find_memory_type(uint32_t type_bits, VkMemoryPropertyFlags required,
                                  VkMemoryPropertyFlags preferred) const {
    for (VkMemoryPropertyFlags flags : {required | preferred, required})
        for (uint32_t i = 0; i < memory_.memoryTypeCount; i++)
            if ((type_bits >> i & 1) && (memory_.memoryTypes[i].propertyFlags & flags) == flags) return i;
    return UINT32_MAX;
}

void Device::set_name(VkObjectType type, uint64_t object, const char* name) const {
    if (!validated_ || !name || !*name) return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = object;
    info.pObjectName = name;
    vkSetDebugUtilsObjectNameEXT(handle, &info);
}

std::vector<std::string> list_devices() { return DeviceMaker::list(); }

Error vulkan_error(VkResult result, const char* call) {
    if (result == VK_ERROR_DEVICE_LOST)
        return {ErrorId::device_lost, "", call, "the device was lost",
                "destroy the device and create it again"};
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        return {ErrorId::limit_exceeded, "", call, "out of memory",
                "draw a smaller scene or close other programs"};
    return {ErrorId::value_out_of_range, "", call,
            fmt::format("the call failed with VkResult {}", int(result)),
            "run with validation on to see why"};
}

}  // namespace coppice::gpu
