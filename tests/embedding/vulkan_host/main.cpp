// A host with a Vulkan of its own: device, queue, command buffer, colour, reversed depth, and boards that move. A forest is
// recorded into its frame, and boards and plants hide each other. vulkan_host SCENE OUT.ppm FRAMES writes the last frame.
#include <vulkan/vulkan.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include "plugins/vegetation/embedded_forest.h"

constexpr uint32_t k_width = 960, k_height = 540;
constexpr float k_near_m = 0.1f, k_fov_rad = 1.0471976f;  // the scene's camera has them
constexpr VkFormat k_formats[] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_D32_SFLOAT};
constexpr VkImageLayout k_layout = VK_IMAGE_LAYOUT_GENERAL;  // between frames, and where the forest finds them
constexpr VkImageUsageFlags k_copies = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
constexpr VkImageUsageFlags k_uses[] = {VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | k_copies,
                                        VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | k_copies};
constexpr VkImageAspectFlags k_aspects[] = {VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_ASPECT_DEPTH_BIT};

void require(bool done, const char* what) {
    if (!done) std::fprintf(stderr, "vulkan_host: %s\n", what), std::exit(3);
}

struct Host {
    VkInstance instance; VkPhysicalDevice physical; VkDevice device; VkQueue queue;
    VkCommandBuffer commands;
    VkImage images[2];  // colour, depth
    VkImageView views[2];
    VkBuffer read_back;
    const char* rgba;
};

// The forest needs one extension, and features of which this host simply takes all that there are.
void make_device(Host& host) {
    VkApplicationInfo program{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo instance{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &program};
    require(!vkCreateInstance(&instance, nullptr, &host.instance), "no Vulkan 1.3");
    uint32_t count = 1;
    require(vkEnumeratePhysicalDevices(host.instance, &count, &host.physical) >= 0 && count, "no Vulkan device");
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &v13};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, &v12};
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v11};
    vkGetPhysicalDeviceFeatures2(host.physical, &features);
    const char* extension = VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features, 0, 1, &queue, 0, nullptr, 1, &extension};
    require(!vkCreateDevice(host.physical, &device, nullptr, &host.device), "vkCreateDevice");
    vkGetDeviceQueue(host.device, 0, 0, &host.queue);
    VkCommandPoolCreateInfo resets{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 2};
    VkCommandPool pool;
    require(!vkCreateCommandPool(host.device, &resets, nullptr, &pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool, {}, 1};
    require(!vkAllocateCommandBuffers(host.device, &commands, &host.commands), "vkAllocateCommandBuffers");
}

VkDeviceMemory allocate(const Host& host, const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties has;
    vkGetPhysicalDeviceMemoryProperties(host.physical, &has);
    uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) || (has.memoryTypes[type].propertyFlags & flags) != flags)
        require(++type < has.memoryTypeCount, "no memory of that type");
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    require(!vkAllocateMemory(host.device, &info, nullptr, &memory), "vkAllocateMemory");
    return memory;
}

// Of both images the forest asks for copies from and to them.
void make_targets(Host& host) {
    VkMemoryRequirements needs;
    for (int i = 0; i < 2; ++i) {
        VkImageCreateInfo image{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, nullptr, 0, VK_IMAGE_TYPE_2D, k_formats[i],
                                {k_width, k_height, 1}, 1, 1, VK_SAMPLE_COUNT_1_BIT, VK_IMAGE_TILING_OPTIMAL, k_uses[i]};
        require(!vkCreateImage(host.device, &image, nullptr, &host.images[i]), "vkCreateImage");
        vkGetImageMemoryRequirements(host.device, host.images[i], &needs);
        vkBindImageMemory(host.device, host.images[i], allocate(host, needs, 0), 0);
        VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, nullptr, 0, host.images[i],
                                   VK_IMAGE_VIEW_TYPE_2D, k_formats[i], {}, {k_aspects[i], 0, 1, 0, 1}};
        require(!vkCreateImageView(host.device, &view, nullptr, &host.views[i]), "vkCreateImageView");
    }
    VkBufferCreateInfo buffer{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, nullptr, 0, 4 * k_width * k_height,
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    require(!vkCreateBuffer(host.device, &buffer, nullptr, &host.read_back), "vkCreateBuffer");
    vkGetBufferMemoryRequirements(host.device, host.read_back, &needs);
    const VkDeviceMemory memory = allocate(host, needs, 6);  // host-visible and coherent
    vkBindBufferMemory(host.device, host.read_back, memory, 0);
    vkMapMemory(host.device, memory, 0, VK_WHOLE_SIZE, 0, (void**)&host.rgba);
}

// The host's own picture: a sky, and five boards, far ones first, that move to the right.
void draw_boards(const Host& host, int frame) {
    VkRenderingAttachmentInfo targets[2] = {};
    VkImageMemoryBarrier cleared[2] = {};
    for (int i = 0; i < 2; ++i) {
        cleared[i] = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, nullptr, 0, VK_ACCESS_MEMORY_WRITE_BIT, {}, k_layout, 0, 0,
                      host.images[i], {k_aspects[i], 0, 1, 0, 1}};
        targets[i] = {VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO, nullptr, host.views[i], k_layout};
        targets[i].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    }
    targets[0].clearValue.color = {{0.4f, 0.6f, 0.8f, 1.0f}};
    vkCmdPipelineBarrier(host.commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                         nullptr, 0, nullptr, 2, cleared);
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO, nullptr, 0, {{0, 0}, {k_width, k_height}}, 1, 0, 1,
                              &targets[0], &targets[1]};
    vkCmdBeginRendering(host.commands, &rendering);
    const float focal_px = k_height / (2.0f * std::tan(0.5f * k_fov_rad));
    for (int board = 4; board >= 0; --board) {
        const float w = 6.0f * float(1 << board), x = w * (0.35f * float(board) - 0.75f + 0.01f * float(frame));
        const VkOffset2D corner{int32_t(k_width) / 2 + int32_t(focal_px * x / w), int32_t(k_height) / 2 - int32_t(focal_px * 2.0f / w)};
        VkClearRect rect{{corner, {uint32_t(focal_px * 1.5f / w), uint32_t(focal_px * 4.0f / w)}}, 0, 1};
        VkClearAttachment clears[2] = {{VK_IMAGE_ASPECT_COLOR_BIT, 0, {}}, {VK_IMAGE_ASPECT_DEPTH_BIT, 0, {}}};
        clears[0].clearValue.color = {{1.0f, 0.2f * float(board), 1.0f, 1.0f}};
        clears[1].clearValue.depthStencil.depth = k_near_m / w;
        vkCmdClearAttachments(host.commands, 2, clears, 1, &rect);
    }
    vkCmdEndRendering(host.commands);  // here the host's frame is as it was before there was a forest
}

int main(int argc, char** argv) {
    require(argc == 4, "SCENE OUT.ppm FRAMES");
    Host host{};
    make_device(host);
    make_targets(host);
    // From here on it is about the forest. Without a queue it never submits and never waits.
    auto forest = coppice::EmbeddedForest::create({.device = {host.instance, host.physical, host.device},
                                                   .scene = argv[1], .width = k_width, .height = k_height});
    require(forest.has_value(), forest ? "" : to_string(forest.error()).c_str());
    const coppice::Camera camera = (*forest)->scene().camera_path.front().camera;
    coppice::HostPicture picture{host.images[0], k_formats[0], k_layout, host.images[1], k_formats[1], k_layout};
    picture.depth_scale = k_near_m;  // depth = near / w
    for (int frame = 0; frame < std::atoi(argv[3]); ++frame) {
        VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        vkBeginCommandBuffer(host.commands, &begin);
        draw_boards(host, frame);
        auto done = (*forest)->record({host.commands, 0, camera, {}, picture});
        require(done.has_value(), done ? "" : to_string(done.error()).c_str());
        VkBufferImageCopy whole{0, 0, 0, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, {}, {k_width, k_height, 1}};
        vkCmdCopyImageToBuffer(host.commands, host.images[0], k_layout, host.read_back, 1, &whole);
        vkEndCommandBuffer(host.commands);
        VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO, nullptr, 0, nullptr, nullptr, 1, &host.commands};
        vkQueueSubmit(host.queue, 1, &submit, VK_NULL_HANDLE);
        require(!vkQueueWaitIdle(host.queue), "the device was lost");
    }
    std::ofstream out(argv[2], std::ios::binary);
    out << "P6 " << k_width << " " << k_height << " 255\n";
    for (uint32_t i = 0; i < k_width * k_height; ++i) out.write(host.rgba + 4 * i, 3);
    return out.good() ? 0 : 2;
}
