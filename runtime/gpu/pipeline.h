// A compute kernel with its bindings (push descriptors, set 0) and push constants.
#pragma once
#include <span>
#include <vector>
#include "runtime/gpu/buffer.h"

namespace coppice::gpu {

enum class BindingKind { storage, texel };  // read-write buffer; read-only texel buffer

struct PipelineSettings {
    const char* name = "";
    std::span<const uint32_t> spirv;
    std::span<const BindingKind> bindings;     // binding 0, 1, ...
    uint32_t push_constant_bytes = 0;          // at most 128
    std::span<const uint32_t> specialization;  // constant_id 0, 1, ...; id 0 is the group size by convention
};

// A buffer, or of a storage buffer what lies from an offset on, which is a multiple of k_range_alignment_bytes.
inline constexpr VkDeviceSize k_range_alignment_bytes = 256;  // the most that a device may ask for
struct BoundBuffer {
    const Buffer* buffer;
    VkDeviceSize offset_bytes = 0;
    BoundBuffer(const Buffer* whole) : buffer(whole) {}
    BoundBuffer(const Buffer* part_of, VkDeviceSize offset) : buffer(part_of), offset_bytes(offset) {}
};

class Pipeline {
  public:
    static Result<Pipeline> create(const Device& device, const PipelineSettings& settings);
    Pipeline() = default;
    Pipeline(Pipeline&& other) noexcept;
    Pipeline& operator=(Pipeline&& other) noexcept;
    ~Pipeline();

    // Binds pipeline, buffers (as many as bindings; texel bindings use texel_view()) and push constants.
    void bind(VkCommandBuffer commands, std::span<const BoundBuffer> buffers, const void* push_constants,
              uint32_t push_constant_bytes) const;
    // Any number of groups: laid out over x and y so that no axis exceeds the device's limit. The kernel
    // computes its group as gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x and returns where that
    // is >= its count.
    void dispatch(VkCommandBuffer commands, uint32_t groups) const;
    // VkDispatchIndirectCommand at offset.
    void dispatch_indirect(VkCommandBuffer commands, const Buffer& arguments, VkDeviceSize offset) const;
    explicit operator bool() const { return pipeline_ != VK_NULL_HANDLE; }

  private:
    const Device* device_ = nullptr;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    std::vector<BindingKind> bindings_;
};

}  // namespace coppice::gpu
