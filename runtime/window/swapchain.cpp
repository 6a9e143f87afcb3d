#include "runtime/window/swapchain.h"

#include <algorithm>
#include <utility>
#include <fmt/format.h>
#include "runtime/gpu/vulkan.h"

namespace coppice {
namespace {

constexpr uint64_t k_acquire_timeout_ns =
    1'000'000'000;  // a hidden window may never get an image: skip its frame
constexpr const char* k_headless_remedy = "run without a window";

// Formats whose bytes are the pixels' own come first, then those that a blit converts.
constexpr VkFormat k_formats[] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_UNORM,
                                  VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_R8G8B8A8_SRGB,
                                  VK_FORMAT_B8G8R8A8_SRGB};

// Pixels are encoded already: where the surface encodes too, the blit must decode first.
VkFormat staging_format(VkFormat format) {
    bool encodes = format == VK_FORMAT_R8G8B8A8_SRGB || format == VK_FORMAT_B8G8R8A8_SRGB;
    return encodes ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
}

bool takes_copy(VkFormat format) {
    return format == VK_FORMAT_R8G8B8A8_UNORM || format == VK_FORMAT_R8G8B8A8_SRGB;
}

VkImageMemoryBarrier2 transition(VkImage image, VkImageLayout from, VkImageLayout to, VkAccessFlags2 before,
                                 VkAccessFlags2 after) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    // Transfers wait for the acquired image, so the transition must come after that wait: same stage.
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
    barrier.srcAccessMask = before;
    barrier.dstStageMask = after ? VK_PIPELINE_STAGE_2_TRANSFER_BIT : VK_PIPELINE_STAGE_2_NONE;
    barrier.dstAccessMask = after;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    return barrier;
}

void wait_for(VkCommandBuffer commands, std::initializer_list<VkImageMemoryBarrier2> images,
              const VkMemoryBarrier2* memory = nullptr) {
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = uint32_t(images.size());
    dependency.pImageMemoryBarriers = images.begin();
    dependency.memoryBarrierCount = memory ? 1 : 0;
    dependency.pMemoryBarriers = memory;
    vkCmdPipelineBarrier2(commands, &dependency);
}

Result<VkSemaphore> make_semaphore(const gpu::Device& device) {
    VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    VkResult result = vkCreateSemaphore(device.handle, &info, nullptr, &semaphore);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkCreateSemaphore"));
    return semaphore;
}

}  // namespace

Result<Swapchain> Swapchain::create(const gpu::Device& device, VkSurfaceKHR surface) {
    Swapchain swapchain;
    swapchain.device_ = &device;
    swapchain.surface_ = surface;
    VkBool32 supported = VK_FALSE;
    VkResult result =
        vkGetPhysicalDeviceSurfaceSupportKHR(device.physical, device.queue_family, surface, &supported);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkGetPhysicalDeviceSurfaceSupportKHR"));
    if (!supported)
        return fail(ErrorId::device_missing, "", "",
                    fmt::format("{} cannot present to this display", device.name), k_headless_remedy);
    COPPICE_CHECK(swapchain.choose_format());
    return swapchain;
}

Status Swapchain::choose_format() {
    uint32_t count = 0;
    VkResult result = vkGetPhysicalDeviceSurfaceFormatsKHR(device_->physical, surface_, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> offered(count);
    if (result == VK_SUCCESS)
        result = vkGetPhysicalDeviceSurfaceFormatsKHR(device_->physical, surface_, &count, offered.data());
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return fail(gpu::vulkan_error(result, "vkGetPhysicalDeviceSurfaceFormatsKHR"));
    offered.resize(count);
    for (VkFormat wanted : k_formats)
        for (const VkSurfaceFormatKHR& format : offered) {
            if (format.format != wanted || format.colorSpace != VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) continue;
            VkFormatProperties properties{};
            vkGetPhysicalDeviceFormatProperties(device_->physical, wanted, &properties);
            if (!takes_copy(wanted) && !(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_DST_BIT))
                continue;
            format_ = format;
            return {};
        }
    return fail(ErrorId::device_missing, "", "", "the display takes no format of 8 or 10 bits a channel",
                k_headless_remedy);
}

Status Swapchain::make(VkExtent2D drawable) {
    VkResult result = vkDeviceWaitIdle(device_->handle);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkDeviceWaitIdle"));
    VkSurfaceCapabilitiesKHR has{};
    result = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_->physical, surface_, &has);
    if (result != VK_SUCCESS)
        return fail(gpu::vulkan_error(result, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR"));
    if (!(has.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
        return fail(ErrorId::device_missing, "", "", "the display's images cannot be copied to",
                    k_headless_remedy);

    extent_ = has.currentExtent;
    if (extent_.width == UINT32_MAX) {
        extent_.width = std::clamp(drawable.width, has.minImageExtent.width, has.maxImageExtent.width);
        extent_.height = std::clamp(drawable.height, has.minImageExtent.height, has.maxImageExtent.height);
    }
    if (!extent_.width || !extent_.height) return {};  // minimised meanwhile; still stale

    // Without tearing, and without waiting for the display where that can be had.
    uint32_t count = 0;
    vkGetPhysicalDeviceSurfacePresentModesKHR(device_->physical, surface_, &count, nullptr);
    std::vector<VkPresentModeKHR> modes(count);
    vkGetPhysicalDeviceSurfacePresentModesKHR(device_->physical, surface_, &count, modes.data());
    bool mailbox = std::find(modes.begin(), modes.end(), VK_PRESENT_MODE_MAILBOX_KHR) != modes.end();

    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = std::max(has.minImageCount, mailbox ? 3u : 2u);
    if (has.maxImageCount) info.minImageCount = std::min(info.minImageCount, has.maxImageCount);
    info.imageFormat = format_.format;
    info.imageColorSpace = format_.colorSpace;
    info.imageExtent = extent_;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = has.currentTransform;
    info.compositeAlpha = has.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = mailbox ? VK_PRESENT_MODE_MAILBOX_KHR : VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    info.oldSwapchain = swapchain_;
    VkSwapchainKHR made = VK_NULL_HANDLE;
    result = vkCreateSwapchainKHR(device_->handle, &info, nullptr, &made);
    vkDestroySwapchainKHR(device_->handle, swapchain_, nullptr);
    for (Image& image : images_) vkDestroySemaphore(device_->handle, image.drawn, nullptr);
    images_.clear();
    swapchain_ = made;
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkCreateSwapchainKHR"));

    result = vkGetSwapchainImagesKHR(device_->handle, swapchain_, &count, nullptr);
    std::vector<VkImage> images(count);
    if (result == VK_SUCCESS)
        result = vkGetSwapchainImagesKHR(device_->handle, swapchain_, &count, images.data());
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkGetSwapchainImagesKHR"));
    for (VkImage image : images) {
        COPPICE_TRY(VkSemaphore drawn, make_semaphore(*device_));
        images_.push_back({image, drawn});
    }
    if (!takes_copy(format_.format)) COPPICE_CHECK(make_staging(extent_));
    stale_ = false;
    return {};
}

Status Swapchain::make_staging(VkExtent2D size) {
    destroy_staging();
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = staging_format(format_.format);
    info.extent = {size.width, size.height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkResult result = vkCreateImage(device_->handle, &info, nullptr, &staging_);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkCreateImage"));
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device_->handle, staging_, &needs);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex =
        device_->find_memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    result = vkAllocateMemory(device_->handle, &allocate, nullptr, &staging_memory_);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkAllocateMemory"));
    result = vkBindImageMemory(device_->handle, staging_, staging_memory_, 0);
    if (result != VK_SUCCESS) return fail(gpu::vulkan_error(result, "vkBindImageMemory"));
    return {};
}

void Swapchain::destroy_staging() {
    vkDestroyImage(device_->handle, staging_, nullptr);
    vkFreeMemory(device_->handle, staging_memory_, nullptr);
    staging_ = VK_NULL_HANDLE;
    staging_memory_ = VK_NULL_HANDLE;
}

void Swapchain::record_copy(VkCommandBuffer commands, const gpu::Buffer& pixels, VkImage target) const {
    VkMemoryBarrier2 drawn{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    drawn.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    drawn.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    drawn.dstStageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
    drawn.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
    VkMemoryBarrier2 copied{
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};  // before the next frame writes the pixels again
    copied.srcStageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
    copied.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;

    constexpr VkImageLayout k_undefined = VK_IMAGE_LAYOUT_UNDEFINED,
                            k_source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            k_target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    constexpr VkAccessFlags2 k_read = VK_ACCESS_2_TRANSFER_READ_BIT, k_write = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    VkImageSubresourceLayers layer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    VkBufferImageCopy copy{0, 0, 0, layer, {}, {extent_.width, extent_.height, 1}};
    VkImage copy_target = staging_ ? staging_ : target;
    if (staging_)
        wait_for(commands,
                 {transition(target, k_undefined, k_target, 0, k_write),
                  transition(staging_, k_undefined, k_target, 0, k_write)},
                 &drawn);
    else
        wait_for(commands, {transition(target, k_undefined, k_target, 0, k_write)}, &drawn);
    vkCmdCopyBufferToImage(commands, pixels.handle(), copy_target, k_target, 1, &copy);
    if (staging_) {
        wait_for(commands, {transition(staging_, k_target, k_source, k_write, k_read)});
        VkOffset3D end{int32_t(extent_.width), int32_t(extent_.height), 1};
        VkImageBlit blit{layer, {{}, end}, layer, {{}, end}};
        vkCmdBlitImage(commands, staging_, k_source, target, k_target, 1, &blit, VK_FILTER_NEAREST);
    }
    wait_for(commands, {transition(target, k_target, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, k_write, 0)}, &copied);
}

Result<bool> Swapchain::present(gpu::CommandRing& ring, VkCommandBuffer commands, const gpu::Buffer& pixels,
                                VkExtent2D size, VkExtent2D drawable) {
    auto skip = [&ring]() -> Result<bool> {
        COPPICE_CHECK(ring.submit());
        return false;
    };
    if (!drawable.width || !drawable.height) return skip();
    if (stale_) COPPICE_CHECK(make(drawable));
    if (stale_ || extent_.width != size.width || extent_.height != size.height) {
        stale_ = true;
        return skip();
    }
    while (acquired_.size() < ring.slots()) {
        COPPICE_TRY(VkSemaphore semaphore, make_semaphore(*device_));
        acquired_.push_back(semaphore);
    }
    // Its last wait was in a frame that ring.begin() has waited for.
    VkSemaphore acquired = acquired_[acquired_count_ % acquired_.size()];
    uint32_t index = 0;
    VkResult result = vkAcquireNextImageKHR(device_->handle, swapchain_, k_acquire_timeout_ns, acquired,
                                            VK_NULL_HANDLE, &index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) stale_ = true;
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_TIMEOUT || result == VK_NOT_READY) return skip();
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR)
        return fail(gpu::vulkan_error(result, "vkAcquireNextImageKHR"));
    acquired_count_++;

    const Image& image = images_[index];
    record_copy(commands, pixels, image.image);
    COPPICE_CHECK(ring.submit(acquired, image.drawn));
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &image.drawn;
    info.swapchainCount = 1;
    info.pSwapchains = &swapchain_;
    info.pImageIndices = &index;
    VkResult presented = vkQueuePresentKHR(device_->queue, &info);
    if (result == VK_SUBOPTIMAL_KHR || presented == VK_SUBOPTIMAL_KHR ||
        presented == VK_ERROR_OUT_OF_DATE_KHR)
        stale_ = true;
    if (presented == VK_ERROR_OUT_OF_DATE_KHR) return false;
    if (presented != VK_SUCCESS && presented != VK_SUBOPTIMAL_KHR)
        return fail(gpu::vulkan_error(presented, "vkQueuePresentKHR"));
    return true;
}

Swapchain::Swapchain(Swapchain&& other) noexcept { *this = std::move(other); }

Swapchain& Swapchain::operator=(Swapchain&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(surface_, other.surface_);
    std::swap(format_, other.format_);
    std::swap(swapchain_, other.swapchain_);
    std::swap(extent_, other.extent_);
    std::swap(images_, other.images_);
    std::swap(acquired_, other.acquired_);
    std::swap(acquired_count_, other.acquired_count_);
    std::swap(staging_, other.staging_);
    std::swap(staging_memory_, other.staging_memory_);
    std::swap(stale_, other.stale_);
    return *this;
}

Swapchain::~Swapchain() {
    if (!device_) return;
    vkDeviceWaitIdle(device_->handle);
    destroy_staging();
    for (Image& image : images_) vkDestroySemaphore(device_->handle, image.drawn, nullptr);
    for (VkSemaphore semaphore : acquired_) vkDestroySemaphore(device_->handle, semaphore, nullptr);
    vkDestroySwapchainKHR(device_->handle, swapchain_, nullptr);
    vkDestroySurfaceKHR(device_->instance, surface_, nullptr);
}

}  // namespace coppice
