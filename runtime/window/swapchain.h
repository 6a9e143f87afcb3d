// The images of a surface, made again whenever the surface changes, and the way of a buffer of pixels into
// them.
#pragma once
#include <vector>
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"
#include "runtime/gpu/device.h"

namespace coppice {

class Swapchain {
  public:
    // Takes the surface, also where it fails. Requires a device made with present = true.
    static Result<Swapchain> create(const gpu::Device& device, VkSurfaceKHR surface);
    Swapchain() = default;
    Swapchain(Swapchain&& other) noexcept;
    Swapchain& operator=(Swapchain&& other) noexcept;
    ~Swapchain();  // waits for the device

    // To be made again before the next picture.
    void invalidate() { stale_ = true; }

    // As Window::present. drawable: the window's size now, for surfaces that take any. Submits the ring's
    // frame in every case but an error.
    Result<bool> present(gpu::CommandRing& ring, VkCommandBuffer commands, const gpu::Buffer& pixels,
                         VkExtent2D size, VkExtent2D drawable);
    explicit operator bool() const { return surface_ != VK_NULL_HANDLE; }

  private:
    Status choose_format();
    Status make(VkExtent2D drawable);
    Status make_staging(VkExtent2D size);
    void destroy_staging();
    void record_copy(VkCommandBuffer commands, const gpu::Buffer& pixels, VkImage target) const;

    struct Image {
        VkImage image = VK_NULL_HANDLE;
        VkSemaphore drawn = VK_NULL_HANDLE;  // waited for by its presentation
    };
    const gpu::Device* device_ = nullptr;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSurfaceFormatKHR format_{};
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    std::vector<Image> images_;
    std::vector<VkSemaphore> acquired_;  // one a frame in flight
    uint64_t acquired_count_ = 0;
    VkImage staging_ = VK_NULL_HANDLE;  // where the surface's channels are in another order than the pixels'
    VkDeviceMemory staging_memory_ = VK_NULL_HANDLE;
    bool stale_ = true;
};

}  // namespace coppice
