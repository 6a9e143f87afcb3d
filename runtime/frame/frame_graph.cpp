// One memory barrier at most before each pass, for all its buffers: hardware and drivers act on whole caches
// and stages, so naming buffers gains nothing, and a barrier that names none also holds when a resource's
// buffer changes from frame to frame. For the same reason each barrier counts for every resource it happens
// to cover.
#include "runtime/frame/frame_graph.h"

#include <cassert>
#include <fmt/format.h>
#include "runtime/gpu/vulkan.h"

namespace coppice {
namespace {

constexpr VkAccessFlags2 k_write_access =
    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

struct Scope {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};

Scope scope_of(BufferAccess access) {
    constexpr VkPipelineStageFlags2 k_compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    constexpr VkAccessFlags2 k_read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
                             k_write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    switch (access) {
        case BufferAccess::compute_read:
            return {k_compute, k_read | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
        case BufferAccess::compute_write:
            return {k_compute, k_write};
        case BufferAccess::compute_read_write:
        case BufferAccess::compute_atomic:
            return {k_compute, k_read | k_write};
        case BufferAccess::transfer_read:
            return {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
        case BufferAccess::transfer_write:
            return {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
        case BufferAccess::indirect_read:
            return {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
        case BufferAccess::host_read:
            return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
    }
    return {};
}

const char* name_of(BufferAccess access) {
    switch (access) {
        case BufferAccess::compute_read:
            return "compute read";
        case BufferAccess::compute_write:
            return "compute write";
        case BufferAccess::compute_read_write:
            return "compute read-write";
        case BufferAccess::compute_atomic:
            return "compute atomic";
        case BufferAccess::transfer_read:
            return "transfer read";
        case BufferAccess::transfer_write:
            return "transfer write";
        case BufferAccess::indirect_read:
            return "indirect read";
        case BufferAccess::host_read:
            return "host read";
    }
    return "";
}

bool covers(uint64_t all, uint64_t part) { return (part & ~all) == 0; }

}  // namespace

ResourceIndex FrameGraph::add_buffer(const char* name, const gpu::Buffer* buffer) {
    resources_.push_back({name, buffer});
    return ResourceIndex(resources_.size() - 1);
}

void FrameGraph::set_buffer(ResourceIndex resource, const gpu::Buffer* buffer) {
    resources_[resource].buffer = buffer;
}

const gpu::Buffer* FrameGraph::buffer(ResourceIndex resource) const { return resources_[resource].buffer; }

uint32_t FrameGraph::add_pass(const char* name, std::vector<ResourceUse> uses, Record record) {
    for ([[maybe_unused]] const ResourceUse& use : uses) assert(use.resource < resources_.size());
    passes_.push_back({name, std::move(uses), std::move(record), true, {}});
    return uint32_t(passes_.size() - 1);
}

void FrameGraph::set_active(uint32_t pass, bool active) { passes_[pass].active = active; }

// What must be over before this use; nothing where it may start at once.
void FrameGraph::require(const ResourceUse& use, VkMemoryBarrier2& barrier) const {
    const Resource& resource = resources_[use.resource];
    Scope scope = scope_of(use.access);
    if (use.access == BufferAccess::compute_atomic && resource.atomic) return;
    bool writes = scope.access & k_write_access;
    bool seen = covers(resource.seen_stages, scope.stages) && covers(resource.seen_access, scope.access);
    bool after_write = !resource.write_stages || seen;
    bool after_reads = !writes || covers(resource.after_reads_stages, scope.stages) || !resource.read_stages;
    if (after_write && after_reads) return;
    if (!after_write) {
        barrier.srcStageMask |= resource.write_stages;
        barrier.srcAccessMask |= resource.write_access;
    }
    if (!after_reads) barrier.srcStageMask |= resource.read_stages;
    barrier.dstStageMask |= scope.stages;
    barrier.dstAccessMask |= scope.access;
}

// A pass may use one resource in several ways, in any order of the list.
void FrameGraph::note(const Pass& pass) {
    for (const ResourceUse& use : pass.uses)
        if (scope_of(use.access).access & k_write_access) {
            Resource& resource = resources_[use.resource];
            resource = {resource.name, resource.buffer};
            resource.atomic = true;
        }
    for (const ResourceUse& use : pass.uses) {
        if (use.access == BufferAccess::host_read) continue;
        Resource& resource = resources_[use.resource];
        Scope scope = scope_of(use.access);
        (scope.access & k_write_access ? resource.write_stages : resource.read_stages) |= scope.stages;
        resource.after_reads_stages = 0;
        resource.write_access |= scope.access & k_write_access;
        if (use.access != BufferAccess::compute_atomic) resource.atomic = false;
    }
}

void FrameGraph::emit(VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
    for (Resource& resource : resources_) {
        if (covers(barrier.srcStageMask, resource.write_stages) &&
            covers(barrier.srcAccessMask, resource.write_access)) {
            resource.seen_stages |= barrier.dstStageMask;
            resource.seen_access |= barrier.dstAccessMask;
        }
        if (covers(barrier.srcStageMask, resource.read_stages))
            resource.after_reads_stages |= barrier.dstStageMask;
    }
}

void FrameGraph::record(VkCommandBuffer commands, gpu::Timestamps* timestamps) {
    VkMemoryBarrier2 to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    for (Pass& pass : passes_) {
        pass.barrier = {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        if (!pass.active) continue;
        if (timestamps) timestamps->begin(commands, pass.name);
        for (const ResourceUse& use : pass.uses)
            if (use.access != BufferAccess::host_read) require(use, pass.barrier);
        if (pass.barrier.srcStageMask) emit(commands, pass.barrier);
        note(pass);
        if (pass.record) pass.record(commands);
    }
    if (timestamps) timestamps->end(commands);
    for (const Pass& pass : passes_)
        for (const ResourceUse& use : pass.uses)
            if (pass.active && use.access == BufferAccess::host_read) require(use, to_host);
    if (to_host.srcStageMask) emit(commands, to_host);
}

std::string FrameGraph::describe() const {
    std::string text;
    for (const Pass& pass : passes_) {
        text += pass.name;
        const char* separator = ": ";
        for (const ResourceUse& use : pass.uses) {
            text += fmt::format("{}{} {}", separator, name_of(use.access), resources_[use.resource].name);
            separator = ", ";
        }
        if (!pass.active)
            text += "; off";
        else if (pass.barrier.srcStageMask)
            text += fmt::format(
                "; waits for{}{}",
                pass.barrier.srcStageMask & VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT ? " compute" : "",
                pass.barrier.srcStageMask & VK_PIPELINE_STAGE_2_TRANSFER_BIT ? " transfer" : "");
        text += '\n';
    }
    return text;
}

}  // namespace coppice
