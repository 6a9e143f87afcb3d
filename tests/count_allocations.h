// Counts what a program takes from the heap, by operator new of its own: for one file of a program, and for nothing else.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace coppice::test {

inline std::atomic<size_t> g_allocation_count{0};          // of all threads
inline thread_local size_t t_thread_allocation_count = 0;  // of this one

inline void* count_and_allocate(std::size_t size, std::size_t alignment) {
    ++g_allocation_count;
    ++t_thread_allocation_count;
    void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace coppice::test

// Where one were inlined and the other not, the compiler would warn of a pair that does not match.
[[gnu::noinline]] void* operator new(std::size_t size) {
    return coppice::test::count_and_allocate(size ? size : 1, alignof(std::max_align_t));
}
void* operator new[](std::size_t size) { return operator new(size); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    return coppice::test::count_and_allocate(size ? size : 1, std::size_t(alignment));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
