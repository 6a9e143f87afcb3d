#include "runtime/gpu/commands.h"

#include <cassert>
#include <utility>
#include "runtime/gpu/vulkan.h"

namespace coppice::gpu {

double Timestamps::total_ms() const {
    double sum_ms = 0.0;
    for (const Section& section : results_) sum_ms += section.ms;
    return sum_ms;
}

void Timestamps::begin(VkCommandBuffer commands, const char* name) { mark(commands, name); }

void Timestamps::end(VkCommandBuffer commands) {
    if (mark_count_ && names_[mark_count_ - 1]) mark(commands, nullptr);
}

void Timestamps::mark(VkCommandBuffer commands, const char* name) {
    if (!pool_ || mark_count_ == k_mark_limit) return;
    if (name && mark_count_ == k_mark_limit - 1) name = nullptr;  // the last mark can only end a section
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, mark_count_);
    names_[mark_count_++] = name;
}

void Timestamps::read() {
    results_.clear();
    if (mark_count_ < 2) return;
    uint64_t ticks[k_mark_limit];
    VkResult result = vkGetQueryPoolResults(device_, pool_, 0, mark_count_, sizeof(ticks), ticks,
                                            sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
    if (result != VK_SUCCESS) return;
    for (uint32_t i = 0; i + 1 < mark_count_; i++)
        if (names_[i])
            results_.push_back({names_[i], double((ticks[i + 1] - ticks[i]) & tick_mask_) * tick_ns_ * 1e-6});
}

Result<CommandRing> CommandRing::create(const Device& device, uint32_t slots) {
    assert(slots >= 1 && slots <= 4);
    CommandRing ring;
    ring.device_ = &device;
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
    VkResult result = vkCreateSemaphore(device.handle, &semaphore, device.allocator, &ring.timeline_);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateSemaphore"));

    ring.frames_.resize(slots);
    for (Slot& slot : ring.frames_) {
        VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
        pool.queueFamilyIndex = device.queue_family;
        result = vkCreateCommandPool(device.handle, &pool, device.allocator, &slot.pool);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateCommandPool"));
        VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        allocate.commandPool = slot.pool;
        allocate.commandBufferCount = 1;
        result = vkAllocateCommandBuffers(device.handle, &allocate, &slot.commands);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkAllocateCommandBuffers"));

        Timestamps& timestamps = slot.timestamps;
        timestamps.device_ = device.handle;
        timestamps.results_.reserve(Timestamps::k_mark_limit);
        if (device.limits.timestamp_ns == 0.0) continue;
        timestamps.tick_ns_ = device.limits.timestamp_ns;
        timestamps.tick_mask_ = ~uint64_t(0) >> (64 - device.limits.timestamp_bits);
        VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
        queries.queryCount = Timestamps::k_mark_limit;
        result = vkCreateQueryPool(device.handle, &queries, device.allocator, &timestamps.pool_);
        if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkCreateQueryPool"));
    }
    return ring;
}

CommandRing::CommandRing(CommandRing&& other) noexcept { *this = std::move(other); }

CommandRing& CommandRing::operator=(CommandRing&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(timeline_, other.timeline_);
    std::swap(serial_, other.serial_);
    std::swap(frames_, other.frames_);
    return *this;
}

CommandRing::~CommandRing() {
    if (!device_) return;
    vkDeviceWaitIdle(device_->handle);
    for (Slot& slot : frames_) {
        vkDestroyQueryPool(device_->handle, slot.timestamps.pool_, device_->allocator);
        vkDestroyCommandPool(device_->handle, slot.pool, device_->allocator);
    }
    vkDestroySemaphore(device_->handle, timeline_, device_->allocator);
}

Result<CommandRing::Frame> CommandRing::begin() {
    uint32_t index = uint32_t(serial_ % frames_.size());
    Slot& slot = frames_[index];
    COPPICE_CHECK(wait(slot.serial));
    slot.timestamps.read();
    VkResult result = vkResetCommandPool(device_->handle, slot.pool, 0);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkResetCommandPool"));
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    result = vkBeginCommandBuffer(slot.commands, &begin);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkBeginCommandBuffer"));
    slot.timestamps.mark_count_ = 0;
    if (slot.timestamps.pool_)
        vkCmdResetQueryPool(slot.commands, slot.timestamps.pool_, 0, Timestamps::k_mark_limit);
    return Frame{slot.commands, &slot.timestamps, index, serial_ + 1};
}

Status CommandRing::submit(VkSemaphore wait, VkSemaphore signal) {
    Slot& slot = frames_[serial_ % frames_.size()];
    slot.timestamps.end(slot.commands);
    VkResult result = vkEndCommandBuffer(slot.commands);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkEndCommandBuffer"));
    VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    commands.commandBuffer = slot.commands;
    VkSemaphoreSubmitInfo waits{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    waits.semaphore = wait;
    waits.stageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
    VkSemaphoreSubmitInfo signals[2] = {{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO},
                                        {VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO}};
    signals[0].semaphore = timeline_;
    signals[0].value = serial_ + 1;
    signals[0].stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    signals[1].semaphore = signal;
    signals[1].stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.waitSemaphoreInfoCount = wait ? 1 : 0;
    submit.pWaitSemaphoreInfos = &waits;
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &commands;
    submit.signalSemaphoreInfoCount = signal ? 2 : 1;
    submit.pSignalSemaphoreInfos = signals;
    result = vkQueueSubmit2(device_->queue, 1, &submit, VK_NULL_HANDLE);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkQueueSubmit2"));
    slot.serial = ++serial_;
    return {};
}

Status CommandRing::wait(uint64_t serial) {
    assert(serial <= serial_ && "waiting for a frame that was not submitted");
    VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
    info.semaphoreCount = 1;
    info.pSemaphores = &timeline_;
    info.pValues = &serial;
    VkResult result = vkWaitSemaphores(device_->handle, &info, UINT64_MAX);
    if (result != VK_SUCCESS) return fail(vulkan_error(result, "vkWaitSemaphores"));
    return {};
}

}  // namespace coppice::gpu
