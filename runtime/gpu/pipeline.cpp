#include "runtime/gpu/pipeline.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <fmt/format.h>
#include "runtime/gpu/vulkan.h"

namespace coppice::gpu {
namespace {

constexpr uint32_t k_binding_limit = 32;  // every device with push descriptors takes as many

VkDescriptorType type_of(BindingKind kind) {
    return kind == BindingKind::texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                      : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

}  // namespace

Result<Pipeline> Pipeline::create(const Device& device, const PipelineSettings& settings) {
    assert(settings.bindings.size() <= k_binding_limit && "more bindings than every device takes");
    assert(settings.push_constant_bytes <= 128 && settings.push_constant_bytes % 4 == 0);
    Pipeline pipeline;
    pipeline.device_ = &device;
    pipeline.bindings_.assign(settings.bindings.begin(), settings.bindings.end());

    VkDescriptorSetLayoutBinding bindings[k_binding_limit];
    for (uint32_t i = 0; i < pipeline.bindings_.size(); i++)
        bindings[i] = {i, type_of(pipeline.bindings_[i]), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
    set.bindingCount = uint32_t(pipeline.bindings_.size());
    set.pBindings = bindings;
    VkResult result =
        vkCreateDescriptorSetLayout(device.handle, &set, device.allocator, &pipeline.set_layout_);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateDescriptorSetLayout"));

    VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, settings.push_constant_bytes};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &pipeline.set_layout_;
    layout.pushConstantRangeCount = settings.push_constant_bytes ? 1 : 0;
    layout.pPushConstantRanges = &push;
    result = vkCreatePipelineLayout(device.handle, &layout, device.allocator, &pipeline.layout_);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreatePipelineLayout"));

    VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    code.codeSize = settings.spirv.size_bytes();
    code.pCode = settings.spirv.data();
    VkShaderModule module = VK_NULL_HANDLE;
    result = vkCreateShaderModule(device.handle, &code, device.allocator, &module);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateShaderModule"));

    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < settings.specialization.size(); i++) entries.push_back({i, i * 4, 4});
    VkSpecializationInfo specialization{uint32_t(entries.size()), entries.data(),
                                        settings.specialization.size_bytes(), settings.specialization.data()};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization;
    info.layout = pipeline.layout_;
    result = vkCreateComputePipelines(device.handle, VK_NULL_HANDLE, 1, &info, device.allocator,
                                      &pipeline.pipeline_);
    vkDestroyShaderModule(device.handle, module, device.allocator);
    if (result != VK_SUCCESS) {
        Error error = vulkan_error(result, "vkCreateComputePipelines");
        error.place += fmt::format(" (kernel \"{}\")", settings.name);
        return fail(std::move(error));
    }
    device.set_name(VK_OBJECT_TYPE_PIPELINE, uint64_t(pipeline.pipeline_), settings.name);
    return pipeline;
}

Pipeline::Pipeline(Pipeline&& other) noexcept { *this = std::move(other); }

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(pipeline_, other.pipeline_);
    std::swap(layout_, other.layout_);
    std::swap(set_layout_, other.set_layout_);
    std::swap(bindings_, other.bindings_);
    return *this;
}

Pipeline::~Pipeline() {
    if (!device_) return;
    vkDestroyPipeline(device_->handle, pipeline_, device_->allocator);
    vkDestroyPipelineLayout(device_->handle, layout_, device_->allocator);
    vkDestroyDescriptorSetLayout(device_->handle, set_layout_, device_->allocator);
}

void Pipeline::bind(VkCommandBuffer commands, std::span<const BoundBuffer> buffers,
                    const void* push_constants, uint32_t push_constant_bytes) const {
    assert(buffers.size() == bindings_.size() && "as many buffers as bindings");
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    VkDescriptorBufferInfo infos[k_binding_limit];
    VkBufferView views[k_binding_limit];
    VkWriteDescriptorSet writes[k_binding_limit];
    for (uint32_t i = 0; i < buffers.size(); i++) {
        const Buffer& buffer = *buffers[i].buffer;
        VkWriteDescriptorSet& write = writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstBinding = i;
        write.descriptorCount = 1;
        write.descriptorType = type_of(bindings_[i]);
        if (bindings_[i] == BindingKind::texel) {
            assert(buffer.texel_view() && "the buffer has no texel format");
            views[i] = buffer.texel_view();
            write.pTexelBufferView = &views[i];
        } else {
            // A texel buffer may be larger than what a storage binding covers.
            const VkDeviceSize offset = buffers[i].offset_bytes;
            assert(offset % k_range_alignment_bytes == 0 && offset < buffer.size_bytes());
            infos[i] = {buffer.handle(), offset,
                        std::min(buffer.size_bytes() - offset, device_->limits.storage_range_bytes)};
            write.pBufferInfo = &infos[i];
        }
    }
    if (!buffers.empty())
        vkCmdPushDescriptorSetKHR(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0,
                                  uint32_t(buffers.size()), writes);
    if (push_constant_bytes)
        vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_constant_bytes,
                           push_constants);
}

void Pipeline::dispatch(VkCommandBuffer commands, uint32_t groups) const {
    if (!groups) return;
    uint32_t limit = device_->limits.groups_per_axis;
    uint32_t rows = (groups - 1) / limit + 1;
    assert(rows <= limit && "more groups than two axes hold");
    // Even rows, so that fewer groups than rows are launched in vain.
    vkCmdDispatch(commands, (groups - 1) / rows + 1, rows, 1);
}

void Pipeline::dispatch_indirect(VkCommandBuffer commands, const Buffer& arguments,
                                 VkDeviceSize offset) const {
    vkCmdDispatchIndirect(commands, arguments.handle(), offset);
}

}  // namespace coppice::gpu
