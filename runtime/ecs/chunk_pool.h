// Memory for chunks. What is given back is kept by size and handed out again, so that a tile that streams in
// takes the memory of one that streamed out, without asking the system.
#pragma once
#include <array>
#include <cstddef>

namespace coppice {

// One thread at a time.
class ChunkPool {
  public:
    // Keeps at most limit_bytes of returned memory; more goes back to the system.
    explicit ChunkPool(size_t limit_bytes) : limit_bytes_(limit_bytes) {}
    ~ChunkPool() { trim(); }
    ChunkPool(const ChunkPool&) = delete;
    ChunkPool& operator=(const ChunkPool&) = delete;

    // Uninitialised, at a multiple of 64 bytes. Wastes at most an eighth. Throws std::bad_alloc as new does.
    void* allocate(size_t size_bytes);
    // size_bytes as it was asked for.
    void release(void* memory, size_t size_bytes);
    // Gives all that is kept back to the system.
    void trim();

    size_t used_bytes() const { return used_bytes_; }
    size_t kept_bytes() const { return kept_bytes_; }

  private:
    struct Free {
        Free* next;
    };
    static constexpr size_t k_class_count = 8 * 64;
    size_t limit_bytes_;
    size_t used_bytes_ = 0;
    size_t kept_bytes_ = 0;
    std::array<Free*, k_class_count> free_{};
};

}  // namespace coppice
