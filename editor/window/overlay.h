// Dear ImGui drawn over the renderer's picture, into a buffer of pixels like that picture's: so a window shows it, and a test
// reads it, in the way that pictures are.
#pragma once
#include <memory>
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"

struct ImDrawData;

namespace coppice {

class Overlay {
  public:
    // Needs a current ImGui context with its fonts, which must outlive it. Errors: device_missing where the device draws no
    // triangles; limit_exceeded.
    static Result<std::unique_ptr<Overlay>> create(const gpu::Device& device, uint32_t width,
                                                   uint32_t height);
    ~Overlay();  // waits for the device
    Overlay(const Overlay&) = delete;
    Overlay& operator=(const Overlay&) = delete;

    // Before ImGui::NewFrame().
    void begin_frame();
    // `picture` is ready to be copied from; pixels() is ready to be copied from afterwards.
    void record(VkCommandBuffer commands, const gpu::Buffer& picture, ImDrawData* panels);
    // width * height RGBA8, sRGB-encoded, rows from the top.
    const gpu::Buffer& pixels() const { return pixels_; }
    Status resize(uint32_t width, uint32_t height);
    // After the context's fonts changed. Waits for the device.
    Status upload_fonts();

  private:
    Overlay() = default;
    void destroy_image();

    const gpu::Device* device_ = nullptr;
    VkRenderPass pass_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkImage image_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    gpu::Buffer pixels_;
    uint32_t width_ = 0, height_ = 0;
    bool started_ = false;
};

}  // namespace coppice
