#include "plugins/vegetation/draw/host_picture.h"

#include <cmath>
#include "runtime/gpu/vulkan.h"
#include "shaders/composite.comp.h"
#include "shaders/seed_depth.comp.h"

namespace coppice {
namespace {

constexpr uint32_t k_pixels_a_group = 256;  // host_picture.glsl's k_run
constexpr uint32_t k_color_kinds = 3;       // red lowest, blue lowest, halves

using gpu::BindingKind;
constexpr BindingKind k_bindings[] = {BindingKind::storage, BindingKind::storage, BindingKind::storage,
                                      BindingKind::storage, BindingKind::storage, BindingKind::storage};

uint32_t color_kind(VkFormat format) {
    switch (format) {
        case VK_FORMAT_R8G8B8A8_UNORM:
        case VK_FORMAT_R8G8B8A8_SRGB:
            return 0;
        case VK_FORMAT_B8G8R8A8_UNORM:
        case VK_FORMAT_B8G8R8A8_SRGB:
            return 1;
        case VK_FORMAT_R16G16B16A16_SFLOAT:
            return 2;
        default:
            return k_color_kinds;
    }
}

uint32_t pixel_bytes(uint32_t kind) { return kind == 2 ? 8 : 4; }

tl::unexpected<Error> refuse(std::string fault, std::string remedy) {
    return fail(ErrorId::value_out_of_range, "", "host picture", std::move(fault), std::move(remedy));
}

// Both images at once, between the host's layouts and those of copies.
void turn(VkCommandBuffer commands, const HostPicture& picture, VkImageLayout from, VkImageLayout to) {
    std::array<VkImageMemoryBarrier2, 2> images{};
    for (size_t i = 0; i < images.size(); ++i) {
        const VkImageLayout own = i == 0 ? picture.color_layout : picture.depth_layout;
        VkImageMemoryBarrier2& barrier = images[i];
        barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
        barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
        barrier.oldLayout = from == VK_IMAGE_LAYOUT_UNDEFINED ? own : from;
        barrier.newLayout = to == VK_IMAGE_LAYOUT_UNDEFINED ? own : to;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = i == 0 ? picture.color : picture.depth;
        VkImageAspectFlags aspects = VK_IMAGE_ASPECT_COLOR_BIT;
        if (i == 1) aspects = VK_IMAGE_ASPECT_DEPTH_BIT;
        if (i == 1 && picture.depth_format == VK_FORMAT_D32_SFLOAT_S8_UINT)
            aspects |= VK_IMAGE_ASPECT_STENCIL_BIT;
        barrier.subresourceRange = {aspects, 0, 1, 0, 1};
    }
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = uint32_t(images.size());
    dependency.pImageMemoryBarriers = images.data();
    vkCmdPipelineBarrier2(commands, &dependency);
}

VkBufferImageCopy whole(VkImageAspectFlags aspect, uint32_t width, uint32_t height) {
    VkBufferImageCopy region{};
    region.imageSubresource = {aspect, 0, 0, 1};
    region.imageExtent = {width, height, 1};
    return region;
}

Status make_room(const gpu::Device& device, gpu::Buffer& buffer, uint64_t size_bytes, const char* name,
                 gpu::RetiredBuffers& retired) {
    if (buffer.size_bytes() == size_bytes) return {};
    gpu::BufferSettings settings;
    settings.size_bytes = size_bytes;
    settings.name = name;
    COPPICE_TRY(gpu::Buffer made, gpu::Buffer::create(device, settings));
    retired.keep(std::move(buffer));
    buffer = std::move(made);
    return {};
}

}  // namespace

Status HostComposite::prepare(const HostPicture& picture, uint32_t width, uint32_t height,
                              gpu::RetiredBuffers& retired) {
    const uint32_t kind = color_kind(picture.color_format);
    if (kind == k_color_kinds)
        return refuse("colour format " + std::to_string(int(picture.color_format)),
                      "use R8G8B8A8, B8G8R8A8 or R16G16B16A16_SFLOAT");
    if (!picture.depth) return refuse("no depth image", "hand in the depth that the colour was drawn with");
    if (picture.depth_format != VK_FORMAT_D32_SFLOAT && picture.depth_format != VK_FORMAT_D32_SFLOAT_S8_UINT)
        return refuse("depth format " + std::to_string(int(picture.depth_format)),
                      "use D32_SFLOAT or D32_SFLOAT_S8_UINT");
    if (!std::isfinite(picture.depth_offset) || !std::isfinite(picture.depth_scale) ||
        picture.depth_scale == 0.0f)
        return refuse("depth = " + std::to_string(picture.depth_offset) + " + " +
                          std::to_string(picture.depth_scale) + " / w",
                      "take both from depth_of_projection");
    const uint64_t pixels = uint64_t(width) * height;
    COPPICE_CHECK(make_room(device_, color_, std::max<uint64_t>(pixels * pixel_bytes(kind), 16), "host color",
                            retired));
    COPPICE_CHECK(make_room(device_, depth_, std::max<uint64_t>(pixels * 4, 16), "host depth", retired));
    COPPICE_CHECK(
        make_room(device_, words_, std::max<uint64_t>(pixels * 4, 16), "host depth words", retired));
    const uint32_t lanes = device_.limits.group_size;
    if (!seed_pipeline_) {
        const uint32_t constants[] = {lanes};
        COPPICE_TRY(seed_pipeline_, gpu::Pipeline::create(device_, {"seed depth", k_seed_depth_spirv,
                                                                    std::span(k_bindings).first(3),
                                                                    sizeof(Constants), constants}));
    }
    if (!composite_pipelines_[kind]) {
        const uint32_t constants[] = {lanes, kind};
        COPPICE_TRY(composite_pipelines_[kind],
                    gpu::Pipeline::create(
                        device_, {"composite", k_composite_spirv, k_bindings, sizeof(Constants), constants}));
    }
    color_kind_ = kind;
    constants_.width = width;
    constants_.height = height;
    return {};
}

void HostComposite::add_input_passes(const Sources& sources) {
    sources_ = sources;
    color_resource_ = graph_.add_buffer("host color", &color_);
    depth_resource_ = graph_.add_buffer("host depth", &depth_);
    words_resource_ = graph_.add_buffer("host depth words", &words_);
    passes_[0] = graph_.add_pass(
        "host picture in",
        {{color_resource_, BufferAccess::transfer_write}, {depth_resource_, BufferAccess::transfer_write}},
        [this](VkCommandBuffer commands) { copy_in(commands); });
    passes_[1] = graph_.add_pass("host depth",
                                 {{depth_resource_, BufferAccess::compute_read},
                                  {words_resource_, BufferAccess::compute_write},
                                  {sources_.visibility_resource, BufferAccess::compute_write}},
                                 [this](VkCommandBuffer commands) {
                                     const gpu::BoundBuffer buffers[] = {sources_.visibility, &words_, &depth_};
                                     seed_pipeline_.bind(commands, buffers, &constants_, sizeof constants_);
                                     seed_pipeline_.dispatch(
                                         commands,
                                         ((constants_.width - 1) / k_pixels_a_group + 1) * constants_.height);
                                 });
}

void HostComposite::add_output_passes() {
    passes_[2] = graph_.add_pass(
        "composite",
        {{sources_.visibility_resource, BufferAccess::compute_read},
         {sources_.radiance_resource, BufferAccess::compute_read},
         {words_resource_, BufferAccess::compute_read},
         {color_resource_, BufferAccess::compute_read_write},
         {depth_resource_, BufferAccess::compute_write},
         {sources_.counts_resource, BufferAccess::host_read}},
        [this](VkCommandBuffer commands) {
            const gpu::BoundBuffer buffers[] = {sources_.visibility, &words_,           &depth_,
                                            frame_.light,        sources_.radiance, &color_};
            const gpu::Pipeline& pipeline = composite_pipelines_[color_kind_];
            pipeline.bind(commands, buffers, &constants_, sizeof constants_);
            pipeline.dispatch(commands, ((constants_.width - 1) / k_pixels_a_group + 1) * constants_.height);
        });
    passes_[3] = graph_.add_pass(
        "host picture out",
        {{color_resource_, BufferAccess::transfer_read}, {depth_resource_, BufferAccess::transfer_read}},
        [this](VkCommandBuffer commands) { copy_out(commands); });
    set_frame(std::nullopt);
}

void HostComposite::set_frame(const std::optional<Frame>& frame) {
    for (uint32_t pass : passes_) graph_.set_active(pass, frame.has_value());
    if (!frame) return;
    frame_ = *frame;
    constants_.near_m = frame->near_m;
    constants_.depth_offset = frame->picture.depth_offset;
    constants_.depth_scale = frame->picture.depth_scale;
    constants_.side_weight = frame->side_weight;
    constants_.view = frame->view;
}

void HostComposite::copy_in(VkCommandBuffer commands) const {
    const HostPicture& picture = frame_.picture;
    constexpr VkImageLayout k_source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    turn(commands, picture, VK_IMAGE_LAYOUT_UNDEFINED, k_source);
    const auto color = whole(VK_IMAGE_ASPECT_COLOR_BIT, constants_.width, constants_.height);
    const auto depth = whole(VK_IMAGE_ASPECT_DEPTH_BIT, constants_.width, constants_.height);
    vkCmdCopyImageToBuffer(commands, picture.color, k_source, color_.handle(), 1, &color);
    vkCmdCopyImageToBuffer(commands, picture.depth, k_source, depth_.handle(), 1, &depth);
}

void HostComposite::copy_out(VkCommandBuffer commands) const {
    const HostPicture& picture = frame_.picture;
    constexpr VkImageLayout k_source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            k_target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    turn(commands, picture, k_source, k_target);
    const auto color = whole(VK_IMAGE_ASPECT_COLOR_BIT, constants_.width, constants_.height);
    const auto depth = whole(VK_IMAGE_ASPECT_DEPTH_BIT, constants_.width, constants_.height);
    vkCmdCopyBufferToImage(commands, color_.handle(), picture.color, k_target, 1, &color);
    vkCmdCopyBufferToImage(commands, depth_.handle(), picture.depth, k_target, 1, &depth);
    turn(commands, picture, k_target, VK_IMAGE_LAYOUT_UNDEFINED);
}

}  // namespace coppice
