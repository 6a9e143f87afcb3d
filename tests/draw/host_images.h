// Colour and depth as a host has them, cleared to one value each, and read back.
#pragma once
#include <gtest/gtest.h>
#include <array>
#include <bit>
#include <vector>
#include "plugins/vegetation/draw/host_picture.h"
#include "runtime/gpu/vulkan.h"

namespace coppice {

class HostImages {
  public:
    static constexpr VkImageLayout k_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   k_cleared = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;

    HostImages(const gpu::Device& device, uint32_t side, VkFormat color_format)
        : device_(device), side_(side) {
        formats_ = {color_format, VK_FORMAT_D32_SFLOAT};
        pixel_bytes_ = color_format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
        for (size_t i = 0; i < 2; ++i) {
            VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
            info.imageType = VK_IMAGE_TYPE_2D;
            info.format = formats_[i];
            info.extent = {side, side, 1};
            info.mipLevels = info.arrayLayers = 1;
            info.samples = VK_SAMPLE_COUNT_1_BIT;
            info.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
            EXPECT_EQ(vkCreateImage(device.handle, &info, nullptr, &images_[i]), VK_SUCCESS);
            VkMemoryRequirements needs;
            vkGetImageMemoryRequirements(device.handle, images_[i], &needs);
            VkMemoryAllocateInfo memory{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
            memory.allocationSize = needs.size;
            memory.memoryTypeIndex =
                device.find_memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
            EXPECT_EQ(vkAllocateMemory(device.handle, &memory, nullptr, &memories_[i]), VK_SUCCESS);
            EXPECT_EQ(vkBindImageMemory(device.handle, images_[i], memories_[i], 0), VK_SUCCESS);
            gpu::BufferSettings back;
            back.size_bytes = uint64_t(side) * side * 8;
            back.memory = gpu::MemoryUse::readback;
            auto made = gpu::Buffer::create(device, back);
            EXPECT_TRUE(made);
            if (made) back_[i] = std::move(*made);
        }
    }
    ~HostImages() {
        for (VkImage image : images_) vkDestroyImage(device_.handle, image, nullptr);
        for (VkDeviceMemory memory : memories_) vkFreeMemory(device_.handle, memory, nullptr);
    }
    HostImages(const HostImages&) = delete;

    HostPicture picture(DepthConvention convention) const {
        return {images_[0],
                formats_[0],
                k_layout,
                images_[1],
                formats_[1],
                k_layout,
                convention.depth_offset,
                convention.depth_scale};
    }

    void record_clears(VkCommandBuffer commands, VkClearColorValue color, float depth) const {
        barrier(commands, VK_IMAGE_LAYOUT_UNDEFINED, k_cleared);
        const VkImageSubresourceRange color_range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        vkCmdClearColorImage(commands, images_[0], k_cleared, &color, 1, &color_range);
        const VkClearDepthStencilValue depth_value{depth, 0};
        const VkImageSubresourceRange depth_range{VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
        vkCmdClearDepthStencilImage(commands, images_[1], k_cleared, &depth_value, 1, &depth_range);
        barrier(commands, k_cleared, k_layout);
    }
    void record_read_back(VkCommandBuffer commands) const {
        for (size_t i = 0; i < 2; ++i) {
            VkBufferImageCopy region{};
            const VkImageAspectFlags aspects[] = {VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_ASPECT_DEPTH_BIT};
            region.imageSubresource = {aspects[i], 0, 0, 1};
            region.imageExtent = {side_, side_, 1};
            vkCmdCopyImageToBuffer(commands, images_[i], k_layout, back_[i].handle(), 1, &region);
        }
        barrier(commands, k_layout, k_layout);
    }

    // After the device has finished.
    template <class Pixel>
    Pixel color(uint32_t x, uint32_t y) const {
        return back_[0].mapped_as<Pixel>()[size_t(y) * side_ + x];
    }
    float depth(uint32_t x, uint32_t y) const { return back_[1].mapped_as<float>()[size_t(y) * side_ + x]; }

  private:
    void barrier(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const {
        std::array<VkImageMemoryBarrier2, 2> images{};
        for (size_t i = 0; i < 2; ++i) {
            images[i].sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
            images[i].srcStageMask = images[i].dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
            images[i].srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
            images[i].dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
            images[i].oldLayout = from;
            images[i].newLayout = to;
            images[i].image = images_[i];
            const VkImageAspectFlags aspects[] = {VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_ASPECT_DEPTH_BIT};
            images[i].subresourceRange = {aspects[i], 0, 1, 0, 1};
        }
        VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
        memory.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
        memory.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
        VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        dependency.imageMemoryBarrierCount = 2;
        dependency.pImageMemoryBarriers = images.data();
        dependency.memoryBarrierCount = 1;
        dependency.pMemoryBarriers = &memory;
        vkCmdPipelineBarrier2(commands, &dependency);
    }

    const gpu::Device& device_;
    uint32_t side_, pixel_bytes_;
    std::array<VkFormat, 2> formats_;
    std::array<VkImage, 2> images_{};
    std::array<VkDeviceMemory, 2> memories_{};
    std::array<gpu::Buffer, 2> back_;
};

}  // namespace coppice
