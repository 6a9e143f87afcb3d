#include "runtime/ecs/chunk_pool.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <new>

namespace coppice {
namespace {
constexpr std::align_val_t k_alignment{64};

// Eight sizes between each power of two and the next; 512 bytes and up, so that all are multiples of 64.
struct SizeClass {
    size_t index;
    size_t size_bytes;
};

SizeClass size_class_of(size_t size_bytes) {
    size_bytes = std::max<size_t>(size_bytes, 512);
    int shift = std::bit_width(size_bytes - 1) - 4;
    size_t eighths = (size_bytes - 1) >> shift;  // [8, 16)
    if (size_bytes > SIZE_MAX / 4) throw std::bad_alloc();
    return {size_t(shift) * 8 + (eighths - 8), (eighths + 1) << shift};
}
}  // namespace

void* ChunkPool::allocate(size_t size_bytes) {
    SizeClass size = size_class_of(size_bytes);
    void* memory = free_[size.index];
    if (memory) {
        free_[size.index] = free_[size.index]->next;
        kept_bytes_ -= size.size_bytes;
    } else {
        memory = ::operator new(size.size_bytes, k_alignment);
    }
    used_bytes_ += size.size_bytes;
    return memory;
}

void ChunkPool::release(void* memory, size_t size_bytes) {
    SizeClass size = size_class_of(size_bytes);
    used_bytes_ -= size.size_bytes;
    if (kept_bytes_ + size.size_bytes > limit_bytes_) {
        ::operator delete(memory, k_alignment);
        return;
    }
    kept_bytes_ += size.size_bytes;
    free_[size.index] = new (memory) Free{free_[size.index]};
}

void ChunkPool::trim() {
    for (Free*& first : free_)
        while (first) {
            Free* next = first->next;
            ::operator delete(first, k_alignment);
            first = next;
        }
    kept_bytes_ = 0;
}

}  // namespace coppice
