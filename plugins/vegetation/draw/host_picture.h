// A host's picture, which plants are drawn into by depth: copied in, what is nearer drawn over it, copied back.
#pragma once
#include <array>
#include <optional>
#include <span>
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/pipeline.h"
#include "runtime/gpu/retired_buffers.h"

namespace coppice {

// Colour and depth that the host has drawn before the frame is recorded, as large as the vegetation's picture, each with
// one sample, made with TRANSFER_SRC and TRANSFER_DST, used on a queue with graphics.
//
// Barriers: whatever the queue did to both before, in command order, is waited for; afterwards both are in their layouts
// again, and whatever follows may read and write them. The host needs none of its own.
struct HostPicture {
    VkImage color = VK_NULL_HANDLE;  // none: the vegetation makes a whole picture, with sky, in color()
    // R8G8B8A8 or B8G8R8A8, UNORM or SRGB: bytes encoded as sRGB, plants as the tone curve shows them.
    // R16G16B16A16_SFLOAT: linear light before a tone curve, 1 is white.
    VkFormat color_format = VK_FORMAT_R8G8B8A8_UNORM;
    VkImageLayout color_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;  // before and after
    VkImage depth = VK_NULL_HANDLE;
    VkFormat depth_format = VK_FORMAT_D32_SFLOAT;  // or D32_SFLOAT_S8_UINT, whose stencil stays
    VkImageLayout depth_layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;  // before and after
    // What is stored at the distance w along the view, in m: depth = depth_offset + depth_scale / w. depth_of_projection says
    // both for a projection matrix.
    float depth_offset = 0.0f, depth_scale = 0.1f;
    bool operator==(const HostPicture&) const = default;
};

// Of a perspective projection with depth in [0, 1]: depth = (z_of_z * z + z_of_1) / w with z = -w in front of the viewer.
// z_of_z: third row, third column; z_of_1: third row, fourth column. Reversed depth without a far plane is (0, near).
struct DepthConvention {
    float depth_offset, depth_scale;
};
inline DepthConvention depth_of_projection(float z_of_z, float z_of_1) { return {-z_of_z, z_of_1}; }

class HostComposite {
  public:
    // What the rasteriser draws into, and what it is lit by in the frame being recorded.
    struct Sources {
        const gpu::Buffer *visibility, *radiance;
        ResourceIndex visibility_resource, radiance_resource, counts_resource;
    };

    HostComposite(const gpu::Device& device, FrameGraph& graph) : device_(device), graph_(graph) {}

    // Between the clearing of visibility and what is drawn into it.
    void add_input_passes(const Sources& sources);
    // After all light of the frame is in radiance.
    void add_output_passes();

    // Makes what a picture of that kind and size needs. Errors: value_out_of_range (a format that is not taken, no depth, a
    // convention without a scale), limit_exceeded, device_lost.
    Status prepare(const HostPicture& picture, uint32_t width, uint32_t height, gpu::RetiredBuffers& retired);

    // What the next recording does; light: the frame's block. Requires prepare of this picture.
    struct Frame {
        HostPicture picture;
        const gpu::Buffer* light;
        float near_m, side_weight;  // of the view; of a neighbour beside or above over the pixel's own
        uint32_t view;              // RepresentationView
    };
    void set_frame(const std::optional<Frame>& frame);
    uint64_t gpu_bytes() const { return color_.size_bytes() + depth_.size_bytes() + words_.size_bytes(); }

  private:
    struct Constants {
        uint32_t width, height;
        float near_m, depth_offset, depth_scale, side_weight;
        uint32_t view;
    };
    void copy_in(VkCommandBuffer commands) const;
    void copy_out(VkCommandBuffer commands) const;

    const gpu::Device& device_;
    FrameGraph& graph_;
    Sources sources_{};
    gpu::Buffer color_, depth_;  // the host's, as stored
    gpu::Buffer words_;          // its depth as ours
    ResourceIndex color_resource_ = 0, depth_resource_ = 0, words_resource_ = 0;
    gpu::Pipeline seed_pipeline_;
    std::array<gpu::Pipeline, 3> composite_pipelines_;  // by the order of a pixel's bytes
    std::array<uint32_t, 4> passes_{};
    Frame frame_{};
    Constants constants_{};
    uint32_t color_kind_ = 0;
};

}  // namespace coppice
