// Hashes that name content. XXH3-64 of bytes: same bytes, same hash, everywhere.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace coppice {

uint64_t hash_bytes(const void* bytes, size_t size_bytes, uint64_t seed = 0);
inline uint64_t hash_text(std::string_view text, uint64_t seed = 0) {
    return hash_bytes(text.data(), text.size(), seed);
}
template <class T>
uint64_t hash_span(std::span<const T> items, uint64_t seed = 0) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>,
                  "padding would be hashed");
    return hash_bytes(items.data(), items.size_bytes(), seed);
}
// Mixes a second value into a hash; order matters.
uint64_t hash_combine(uint64_t hash, uint64_t value);
// 16 lower-case hexadecimal digits.
std::string hash_to_hex(uint64_t hash);

// A good 32-bit mix of 32 bits (one-to-one); the shaders have the same function, same name.
constexpr uint32_t mix_bits(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

}  // namespace coppice
