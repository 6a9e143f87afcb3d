// A host in C11 with a Vulkan of its own: clears colour and reversed depth, records a forest into its command buffer, submits, and
// writes what came. c_host SCENE OUT.ppm. What the forest says of itself goes to standard output.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>
#ifdef OLDER_HEADER
#include OLDER_HEADER
#else
#include <plugins/vegetation/coppice.h>
#endif

enum { WIDTH = 960, HEIGHT = 540 };
static const float near_m = 0.1f;
static const VkFormat formats[2] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_D32_SFLOAT};

typedef struct Host {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandBuffer commands;
    VkImage images[2];  // colour, depth
    VkBuffer read_back;
    const unsigned char* rgba;
} Host;

static void require(int done, const char* what) {
    if (done) return;
    fprintf(stderr, "c_host: %s\n", what);
    exit(3);
}

static void make_device(Host* host) {
    VkApplicationInfo program = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo instance = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &program};
    require(!vkCreateInstance(&instance, NULL, &host->instance), "no Vulkan 1.3");
    uint32_t count = 1;
    require(vkEnumeratePhysicalDevices(host->instance, &count, &host->physical) >= 0 && count, "no Vulkan device");
    VkPhysicalDeviceVulkan13Features v13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
    VkPhysicalDeviceVulkan11Features v11 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &v12};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v11};
    vkGetPhysicalDeviceFeatures2(host->physical, &features);
    const char* extension = VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &features, .queueCreateInfoCount = 1,
                                 .pQueueCreateInfos = &queue, .enabledExtensionCount = 1, .ppEnabledExtensionNames = &extension};
    require(!vkCreateDevice(host->physical, &device, NULL, &host->device), "vkCreateDevice");
    vkGetDeviceQueue(host->device, 0, 0, &host->queue);
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandPool pool;
    require(!vkCreateCommandPool(host->device, &pool_info, NULL, &pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 1};
    require(!vkAllocateCommandBuffers(host->device, &commands, &host->commands), "vkAllocateCommandBuffers");
}

static VkDeviceMemory allocate(const Host* host, VkMemoryRequirements needs, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties has;
    vkGetPhysicalDeviceMemoryProperties(host->physical, &has);
    uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) || (has.memoryTypes[type].propertyFlags & flags) != flags)
        require(++type < has.memoryTypeCount, "no memory of that type");
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    require(!vkAllocateMemory(host->device, &info, NULL, &memory), "vkAllocateMemory");
    return memory;
}

static void make_targets(Host* host) {
    VkMemoryRequirements needs;
    for (int i = 0; i < 2; ++i) {
        VkImageCreateInfo image = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .format = formats[i],
                                   .extent = {WIDTH, HEIGHT, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
                                   .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                            (i ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
        require(!vkCreateImage(host->device, &image, NULL, &host->images[i]), "vkCreateImage");
        vkGetImageMemoryRequirements(host->device, host->images[i], &needs);
        vkBindImageMemory(host->device, host->images[i], allocate(host, needs, 0), 0);
    }
    VkBufferCreateInfo buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 4 * WIDTH * HEIGHT, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    require(!vkCreateBuffer(host->device, &buffer, NULL, &host->read_back), "vkCreateBuffer");
    vkGetBufferMemoryRequirements(host->device, host->read_back, &needs);
    const VkDeviceMemory memory = allocate(host, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    vkBindBufferMemory(host->device, host->read_back, memory, 0);
    void* mapped = NULL;
    vkMapMemory(host->device, memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    host->rgba = mapped;
}

// A sky, and nothing in front of it.
static void clear(const Host* host) {
    const VkImageSubresourceRange ranges[2] = {{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}, {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1}};
    VkImageMemoryBarrier general[2];
    for (int i = 0; i < 2; ++i)
        general[i] = (VkImageMemoryBarrier){.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .dstAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                            .newLayout = VK_IMAGE_LAYOUT_GENERAL, .image = host->images[i], .subresourceRange = ranges[i]};
    vkCmdPipelineBarrier(host->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 2, general);
    const VkClearColorValue sky = {{0.4f, 0.6f, 0.8f, 1.0f}};
    const VkClearDepthStencilValue nothing = {0.0f, 0};
    vkCmdClearColorImage(host->commands, host->images[0], VK_IMAGE_LAYOUT_GENERAL, &sky, 1, &ranges[0]);
    vkCmdClearDepthStencilImage(host->commands, host->images[1], VK_IMAGE_LAYOUT_GENERAL, &nothing, 1, &ranges[1]);
}

int main(int argc, char** argv) {
    require(argc == 3, "SCENE OUT.ppm");
    Host host = {0};
    make_device(&host);
    make_targets(&host);

    // From here on it is about the forest.
    const CoppiceForestInterface* coppice = coppice_interface(COPPICE_FOREST_INTERFACE, COPPICE_FOREST_VERSION);
    require(coppice != NULL, "another version of the library");
    CoppiceForestSettings settings = {.size_bytes = sizeof settings, .instance = host.instance, .physical_device = host.physical,
                                      .device = host.device, .scene = argv[1], .width = WIDTH, .height = HEIGHT};
    CoppiceForest* forest = NULL;
    const int made = coppice->create(&settings, &forest);
    if (made != COPPICE_DONE) {
        fprintf(stderr, "c_host: %s\n", coppice->message());
        return made;
    }
    CoppiceCamera camera = {.size_bytes = sizeof camera};
    coppice->scene_camera(forest, 0.0, &camera);
    CoppicePicture picture = {.size_bytes = sizeof picture, .color = host.images[0], .color_layout = VK_IMAGE_LAYOUT_GENERAL,
                              .depth = host.images[1], .depth_layout = VK_IMAGE_LAYOUT_GENERAL, .depth_scale = near_m};
    CoppiceFrame frame = {.size_bytes = sizeof frame, .commands = host.commands, .camera = &camera, .picture = &picture};

    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vkBeginCommandBuffer(host.commands, &begin);
    clear(&host);
    require(coppice->record(forest, &frame) == COPPICE_DONE, coppice->message());
    VkBufferImageCopy whole = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(host.commands, host.images[0], VK_IMAGE_LAYOUT_GENERAL, host.read_back, 1, &whole);
    vkEndCommandBuffer(host.commands);
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &host.commands};
    vkQueueSubmit(host.queue, 1, &submit, VK_NULL_HANDLE);
    require(!vkQueueWaitIdle(host.queue), "the device was lost");

    CoppiceReport report;
    memset(&report, 0xee, sizeof report);
    report.size_bytes = sizeof report;
    coppice->report(forest, &report);
    printf("plants %llu models %u %s\n", (unsigned long long)report.plants, coppice->model_count(forest), coppice->model_name(forest, 0));
    CoppicePlant plant = {.size_bytes = sizeof plant, .position = {1.0, 0.0, 2.0}};
    uint32_t number = 0;
    require(coppice->add_plant(forest, &plant, &number) == COPPICE_DONE, coppice->message());
    plant.position[0] = 3.0;
    require(coppice->move_plant(forest, number, &plant) == COPPICE_DONE, coppice->message());
    require(coppice->remove_plant(forest, number) == COPPICE_DONE, coppice->message());
    const int again = coppice->remove_plant(forest, number);
    printf("removed twice: %d %s\n", again, coppice->message());
    coppice->destroy(forest);

    FILE* out = fopen(argv[2], "wb");
    require(out != NULL, "cannot write");
    fprintf(out, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; ++i) fwrite(host.rgba + 4 * i, 3, 1, out);
    return fclose(out) ? 2 : 0;
}
