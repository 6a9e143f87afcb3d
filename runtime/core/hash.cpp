#include "runtime/core/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace coppice {

uint64_t hash_bytes(const void* bytes, size_t size_bytes, uint64_t seed) {
    return XXH3_64bits_withSeed(bytes, size_bytes, seed);
}

uint64_t hash_combine(uint64_t hash, uint64_t value) {
    uint64_t words[2] = {hash, value};
    return XXH3_64bits(words, sizeof words);
}

std::string hash_to_hex(uint64_t hash) {
    std::string text(16, '0');
    for (int i = 15; i >= 0; --i, hash >>= 4) text[size_t(i)] = "0123456789abcdef"[hash & 15];
    return text;
}

}  // namespace coppice
