#include "runtime/core/arena.h"

#include <algorithm>
#include <cstdint>

namespace coppice {

void* Arena::allocate(size_t size_bytes, size_t alignment) {
    for (; block_ < blocks_.size(); ++block_, used_bytes_ = 0) {
        Block& block = blocks_[block_];
        auto base = reinterpret_cast<uintptr_t>(block.memory.get());
        size_t offset = ((base + used_bytes_ + alignment - 1) & ~(alignment - 1)) - base;
        if (offset <= block.size_bytes && size_bytes <= block.size_bytes - offset) {
            used_bytes_ = offset + size_bytes;
            return block.memory.get() + offset;
        }
    }
    if (size_bytes > SIZE_MAX - alignment) throw std::bad_alloc();
    size_t size = std::max(block_bytes_, size_bytes + alignment);
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
    block_ = blocks_.size() - 1;
    used_bytes_ = 0;
    return allocate(size_bytes, alignment);
}

void Arena::reset() {
    block_ = 0;
    used_bytes_ = 0;
}

size_t Arena::reserved_bytes() const {
    size_t total = 0;
    for (const Block& block : blocks_) total += block.size_bytes;
    return total;
}

}  // namespace coppice
