#include "editor/window/overlay.h"

#include <imgui.h>
#include <backends/imgui_impl_vulkan.h>
#include "runtime/gpu/vulkan.h"

namespace coppice {
namespace {

constexpr VkFormat k_format = VK_FORMAT_R8G8B8A8_UNORM;  // panels' colours are encoded, as the picture's are

void pass_barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                  VkPipelineStageFlags2 before, VkAccessFlags2 written, VkPipelineStageFlags2 after,
                  VkAccessFlags2 used) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = before;
    barrier.srcAccessMask = written;
    barrier.dstStageMask = after;
    barrier.dstAccessMask = used;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
}

Status check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return {};
    return fail(gpu::vulkan_error(result, call));
}

Result<VkRenderPass> make_pass(const gpu::Device& device) {
    VkAttachmentDescription attachment{};
    attachment.format = k_format;
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;  // the picture
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    attachment.initialLayout = attachment.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color;
    VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    info.attachmentCount = 1;
    info.pAttachments = &attachment;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    VkRenderPass pass = VK_NULL_HANDLE;
    COPPICE_CHECK(check(vkCreateRenderPass(device.handle, &info, nullptr, &pass), "vkCreateRenderPass"));
    return pass;
}

bool draws_triangles(const gpu::Device& device) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device.physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device.physical, &count, families.data());
    return device.queue_family < count && (families[device.queue_family].queueFlags & VK_QUEUE_GRAPHICS_BIT);
}

}  // namespace

Result<std::unique_ptr<Overlay>> Overlay::create(const gpu::Device& device, uint32_t width, uint32_t height) {
    if (!draws_triangles(device))
        return fail(ErrorId::device_missing, "", "",
                    device.name + " computes on a queue that draws no triangles", "another device");
    std::unique_ptr<Overlay> overlay(new Overlay);
    overlay->device_ = &device;
    COPPICE_TRY(overlay->pass_, make_pass(device));
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    pool.maxSets = 8;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    COPPICE_CHECK(check(vkCreateDescriptorPool(device.handle, &pool, nullptr, &overlay->pool_),
                        "vkCreateDescriptorPool"));
    COPPICE_CHECK(overlay->resize(width, height));
    COPPICE_CHECK(overlay->upload_fonts());
    return overlay;
}

Overlay::~Overlay() {
    vkDeviceWaitIdle(device_->handle);
    if (started_) ImGui_ImplVulkan_Shutdown();
    destroy_image();
    vkDestroyDescriptorPool(device_->handle, pool_, nullptr);
    vkDestroyRenderPass(device_->handle, pass_, nullptr);
}

void Overlay::destroy_image() {
    vkDestroyFramebuffer(device_->handle, framebuffer_, nullptr);
    vkDestroyImageView(device_->handle, view_, nullptr);
    vkDestroyImage(device_->handle, image_, nullptr);
    vkFreeMemory(device_->handle, memory_, nullptr);
    framebuffer_ = VK_NULL_HANDLE;
    view_ = VK_NULL_HANDLE;
    image_ = VK_NULL_HANDLE;
    memory_ = VK_NULL_HANDLE;
}

Status Overlay::resize(uint32_t width, uint32_t height) {
    COPPICE_CHECK(check(vkDeviceWaitIdle(device_->handle), "vkDeviceWaitIdle"));
    destroy_image();
    width_ = width;
    height_ = height;
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = k_format;
    info.extent = {width, height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    COPPICE_CHECK(check(vkCreateImage(device_->handle, &info, nullptr, &image_), "vkCreateImage"));
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device_->handle, image_, &needs);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex =
        device_->find_memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    COPPICE_CHECK(check(vkAllocateMemory(device_->handle, &allocate, nullptr, &memory_), "vkAllocateMemory"));
    COPPICE_CHECK(check(vkBindImageMemory(device_->handle, image_, memory_, 0), "vkBindImageMemory"));
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image_;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = k_format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    COPPICE_CHECK(check(vkCreateImageView(device_->handle, &view, nullptr, &view_), "vkCreateImageView"));
    VkFramebufferCreateInfo framebuffer{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    framebuffer.renderPass = pass_;
    framebuffer.attachmentCount = 1;
    framebuffer.pAttachments = &view_;
    framebuffer.width = width;
    framebuffer.height = height;
    framebuffer.layers = 1;
    COPPICE_CHECK(check(vkCreateFramebuffer(device_->handle, &framebuffer, nullptr, &framebuffer_),
                        "vkCreateFramebuffer"));
    COPPICE_TRY(pixels_, gpu::Buffer::create(*device_, {.size_bytes = VkDeviceSize(width) * height * 4,
                                                        .name = "picture with panels"}));
    return {};
}

Status Overlay::upload_fonts() {
    COPPICE_CHECK(check(vkDeviceWaitIdle(device_->handle), "vkDeviceWaitIdle"));
    if (started_) ImGui_ImplVulkan_Shutdown();
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device_->instance;
    info.PhysicalDevice = device_->physical;
    info.Device = device_->handle;
    info.QueueFamily = device_->queue_family;
    info.Queue = device_->queue;
    info.DescriptorPool = pool_;
    info.MinImageCount = info.ImageCount = 4;  // rings of buffers: as many as frames in flight, and more
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    started_ = ImGui_ImplVulkan_Init(&info, pass_);
    COPPICE_TRY(gpu::CommandRing ring, gpu::CommandRing::create(*device_, 1));
    COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
    ImGui_ImplVulkan_CreateFontsTexture(frame.commands);
    COPPICE_CHECK(ring.submit());
    COPPICE_CHECK(ring.wait(frame.serial));
    ImGui_ImplVulkan_DestroyFontUploadObjects();
    return {};
}

void Overlay::begin_frame() { ImGui_ImplVulkan_NewFrame(); }

void Overlay::record(VkCommandBuffer commands, const gpu::Buffer& picture, ImDrawData* panels) {
    constexpr VkPipelineStageFlags2 k_copy = VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                    k_draw = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
    constexpr VkImageLayout k_target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                            k_drawn = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                            k_source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkBufferImageCopy whole{0, 0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {}, {width_, height_, 1}};
    pass_barrier(commands, image_, VK_IMAGE_LAYOUT_UNDEFINED, k_target, k_copy, 0, k_copy,
                 VK_ACCESS_2_TRANSFER_WRITE_BIT);
    vkCmdCopyBufferToImage(commands, picture.handle(), image_, k_target, 1, &whole);
    pass_barrier(commands, image_, k_target, k_drawn, k_copy, VK_ACCESS_2_TRANSFER_WRITE_BIT, k_draw,
                 VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    begin.renderPass = pass_;
    begin.framebuffer = framebuffer_;
    begin.renderArea = {{0, 0}, {width_, height_}};
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(panels, commands);
    vkCmdEndRenderPass(commands);
    pass_barrier(commands, image_, k_drawn, k_source, k_draw, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, k_copy,
                 VK_ACCESS_2_TRANSFER_READ_BIT);
    // The frame before may still be shown from these pixels; frames are ordered, so a stage is enough.
    vkCmdCopyImageToBuffer(commands, image_, k_source, pixels_.handle(), 1, &whole);
    VkMemoryBarrier2 copied{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    copied.srcStageMask = copied.dstStageMask = k_copy;
    copied.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    copied.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &copied;
    vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace coppice
