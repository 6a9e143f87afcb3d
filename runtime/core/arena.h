// Memory that is handed out by moving a pointer and taken back all at once. Blocks are kept, so a warm frame
// allocates nothing from the heap. Not thread-safe: one arena a thread or a job.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace coppice {

class Arena {
  public:
    explicit Arena(size_t block_bytes = size_t(1) << 20) : block_bytes_(block_bytes) {}

    // Uninitialised; alignment is a power of two. Never null; throws std::bad_alloc as new does.
    void* allocate(size_t size_bytes, size_t alignment = 16);
    template <class T>
    std::span<T> allocate_span(size_t count) {
        static_assert(std::is_trivially_destructible_v<T>);
        if (count > SIZE_MAX / sizeof(T)) throw std::bad_alloc();
        return {static_cast<T*>(allocate(count * sizeof(T), alignof(T))), count};
    }
    // Everything handed out becomes invalid; the blocks stay.
    void reset();
    size_t reserved_bytes() const;

  private:
    struct Block {
        std::unique_ptr<std::byte[]> memory;
        size_t size_bytes;
    };
    std::vector<Block> blocks_;
    size_t block_ = 0;
    size_t used_bytes_ = 0;
    size_t block_bytes_;
};

}  // namespace coppice
