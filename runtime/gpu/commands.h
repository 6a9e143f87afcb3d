// Command buffers for a few frames in flight, on the device's one queue, and times of passes.
#pragma once
#include <span>
#include <vector>
#include "runtime/gpu/device.h"

namespace coppice::gpu {

// GPU times by named section of one frame. Sections follow one another; they do not nest. Sections past the
// limit are not timed.
class Timestamps {
  public:
    static constexpr uint32_t k_section_limit = 64;
    struct Section {
        const char* name;
        double ms;
    };
    // Sections of the last finished frame that used this slot; empty before, or where the device has no
    // timestamps.
    std::span<const Section> sections() const { return results_; }
    double total_ms() const;
    void begin(VkCommandBuffer commands,
               const char* name);  // ends the section before; name must outlive the frame
    void end(VkCommandBuffer commands);

  private:
    friend class CommandRing;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    void mark(VkCommandBuffer commands, const char* name);
    void read();
    static constexpr uint32_t k_mark_limit = 2 * k_section_limit;
    double tick_ns_ = 0.0;
    uint64_t tick_mask_ = 0;
    uint32_t mark_count_ = 0;
    const char* names_[k_mark_limit] = {};  // of what begins at each mark; nullptr: no section
    std::vector<Section> results_;
};

class CommandRing {
  public:
    // slots: frames that may be in flight, 1 to 4.
    static Result<CommandRing> create(const Device& device, uint32_t slots);
    CommandRing() = default;
    CommandRing(CommandRing&& other) noexcept;
    CommandRing& operator=(CommandRing&& other) noexcept;
    ~CommandRing();  // waits for the device

    // Waits until the slot's last frame has finished, reads its timestamps, begins recording. slot: which of
    // the ring.
    struct Frame {
        VkCommandBuffer commands;
        Timestamps* timestamps;
        uint32_t slot;
        uint64_t serial;  // 1, 2, ...
    };
    Result<Frame> begin();
    // Ends and submits; where given, the frame's transfers wait for `wait` (a swapchain image) and `signal`
    // is signalled when all is done.
    Status submit(VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);
    // Until the frame with this serial has finished. Requires that it was submitted.
    Status wait(uint64_t serial);
    uint32_t slots() const { return uint32_t(frames_.size()); }

  private:
    struct Slot {
        VkCommandPool pool = VK_NULL_HANDLE;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        Timestamps timestamps;
        uint64_t serial = 0;
    };
    const Device* device_ = nullptr;
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    uint64_t serial_ = 0;  // of the last frame submitted
    std::vector<Slot> frames_;
};

}  // namespace coppice::gpu
