#include "tests/faults/vulkan_faults.h"

#include <atomic>
#include <cstring>
#include <string_view>
#include "runtime/gpu/vulkan.h"

namespace coppice::faults {
namespace {

enum CallId : int {
#define COPPICE_CALL(name) k_##name,
#include "tests/faults/vulkan_calls.inc"
    k_call_count
};
constexpr std::string_view k_names[] = {
#define COPPICE_CALL(name) #name,
#include "tests/faults/vulkan_calls.inc"
};

PFN_vkVoidFunction g_originals[k_call_count];
PFN_vkGetInstanceProcAddr g_get_original;
// Frames are recorded by one thread, buffers may be made by others.
std::atomic<int64_t> g_countdown{-1}, g_live{0};
std::atomic<int> g_failed{-1};
VkResult g_result = VK_SUCCESS;

bool strikes(int id) {
    if (g_countdown.load() < 0 || g_countdown.fetch_sub(1) != 0) return false;
    g_failed = id;
    return true;
}

template <int id, class Function>
struct Watched;

template <int id, class... Arguments>
struct Watched<id, VkResult(VKAPI_PTR*)(Arguments...)> {
    static VkResult VKAPI_CALL call(Arguments... arguments) {
        if (strikes(id)) return g_result;
        const auto original = reinterpret_cast<VkResult(VKAPI_PTR*)(Arguments...)>(g_originals[id]);
        const VkResult result = original(arguments...);
        constexpr bool makes = k_names[id].starts_with("vkCreate") || id == k_vkAllocateMemory;
        if (makes && result == VK_SUCCESS) ++g_live;
        return result;
    }
};

// What goes is their last argument but the allocator.
template <int id, class... Arguments>
struct Watched<id, void(VKAPI_PTR*)(Arguments...)> {
    static void VKAPI_CALL call(Arguments... arguments) {
        const void* handles[] = {arguments...};
        if (handles[sizeof...(Arguments) - 2]) --g_live;
        reinterpret_cast<void(VKAPI_PTR*)(Arguments...)>(g_originals[id])(arguments...);
    }
};

PFN_vkVoidFunction watched(int id) {
    switch (id) {
#define COPPICE_CALL(name) \
    case k_##name:         \
        return reinterpret_cast<PFN_vkVoidFunction>(&Watched<k_##name, PFN_##name>::call);
#include "tests/faults/vulkan_calls.inc"
        default:
            return nullptr;
    }
}

PFN_vkVoidFunction VKAPI_CALL get_watched(VkInstance instance, const char* name) {
    const PFN_vkVoidFunction original = g_get_original(instance, name);
    for (int id = 0; original && id < k_call_count; ++id)
        if (name == k_names[id]) {
            g_originals[id] = original;
            return watched(id);
        }
    return original;
}

}  // namespace

void watch_vulkan() {
    if (g_get_original || volkInitialize() != VK_SUCCESS) return;
    g_get_original = vkGetInstanceProcAddr;
    vkGetInstanceProcAddr = get_watched;
    vkCreateInstance = reinterpret_cast<PFN_vkCreateInstance>(get_watched(nullptr, "vkCreateInstance"));
}

void fail_nth(uint64_t n, VkResult result) {
    g_result = result;
    g_failed = -1;
    g_countdown = int64_t(n);
}

std::string stop_failing() {
    g_countdown = -1;
    return g_failed < 0 ? std::string() : std::string(k_names[g_failed]);
}

int64_t live_objects() { return g_live; }

}  // namespace coppice::faults
