// Buffers that were replaced while frames in flight may still use them: kept until every slot has come round once more,
// so that no frame waits for the device.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>
#include "runtime/gpu/buffer.h"

namespace coppice::gpu {

class RetiredBuffers {
  public:
    // slots: frames in flight, 1 to 32.
    explicit RetiredBuffers(uint32_t slots = 1) : all_slots_(uint32_t((uint64_t(1) << slots) - 1)) {}

    // From any frame, also between frames. What was never made is dropped at once.
    void keep(Buffer&& buffer) {
        if (buffer) kept_.push_back({std::move(buffer), all_slots_});
    }
    // The device has finished the slot's last frame.
    void begin_slot(uint32_t slot) {
        for (Kept& kept : kept_) kept.slots_to_come &= ~(1u << slot);
        std::erase_if(kept_, [](const Kept& kept) { return kept.slots_to_come == 0; });
    }
    // The device is idle.
    void drop_all() { kept_.clear(); }
    uint64_t size_bytes() const {
        uint64_t total = 0;
        for (const Kept& kept : kept_) total += kept.buffer.size_bytes();
        return total;
    }

  private:
    struct Kept {
        Buffer buffer;
        uint32_t slots_to_come;
    };
    uint32_t all_slots_;
    std::vector<Kept> kept_;
};

}  // namespace coppice::gpu
