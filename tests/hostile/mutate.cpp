#include "tests/hostile/mutate.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <iterator>
#include <string_view>

namespace coppice::hostile {
namespace {

constexpr uint64_t k_words[] = {0,
                                1,
                                2,
                                0x7f,
                                0x80,
                                0xff,
                                0x7fff,
                                0xffff,
                                0x7fffffff,
                                0x80000000,
                                0xffffffff,
                                0xfffffffe,
                                0x7fc00000 /* not a number */,
                                0x7f800000 /* infinity */,
                                0xff800000,
                                0x40000000,
                                0x7fffffffffffffff,
                                0xffffffffffffffff,
                                0x100000000};
constexpr std::string_view k_tokens[] = {"0",
                                         "-0",
                                         "-1",
                                         "1e308",
                                         "-1e308",
                                         "1e-320",
                                         "1e999",
                                         "4294967295",
                                         "4294967296",
                                         "18446744073709551616",
                                         "2147483648",
                                         "0.5",
                                         "1e6",
                                         "NaN",
                                         "null",
                                         "true",
                                         "[]",
                                         "{}",
                                         "\"\"",
                                         "\"../../..\"",
                                         "[[[[[[[[[[[[[[[[",
                                         "\"\\ud800\"",
                                         "\xff\xfe",
                                         ",",
                                         ":",
                                         "]",
                                         "}",
                                         "\"",
                                         "\n",
                                         "1 2",
                                         "data:,",
                                         "\"a\":1"};

bool is_digit(std::byte byte) { return std::isdigit(int(byte)) != 0; }

size_t place_in(const Bytes& bytes, Random& random) {
    return bytes.empty() ? 0 : random.next_below(uint32_t(bytes.size()));
}

void replace(Bytes& bytes, size_t first, size_t count, std::string_view text) {
    count = std::min(count, bytes.size() - first);
    bytes.erase(bytes.begin() + long(first), bytes.begin() + long(first + count));
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    bytes.insert(bytes.begin() + long(first), begin, begin + text.size());
}

// A number of the text near a place, or a name, becomes something else.
void replace_token(Bytes& bytes, Random& random) {
    size_t first = place_in(bytes, random);
    while (first < bytes.size() && !is_digit(bytes[first])) ++first;
    size_t last = first;
    while (last < bytes.size() &&
           (is_digit(bytes[last]) || bytes[last] == std::byte('.') || bytes[last] == std::byte('e')))
        ++last;
    replace(bytes, std::min(first, bytes.size()), last - first,
            k_tokens[random.next_below(uint32_t(std::size(k_tokens)))]);
}

void change_word(Bytes& bytes, Random& random) {
    const size_t size = size_t(1) << random.next_below(4);
    if (bytes.size() < size) return;
    size_t at = place_in(bytes, random);
    at = std::min(at - at % size, bytes.size() - size);
    const uint64_t word = k_words[random.next_below(uint32_t(std::size(k_words)))];
    std::memcpy(bytes.data() + at, &word, size);
}

void change(const Reader& reader, Bytes& bytes, Random& random) {
    const size_t at = place_in(bytes, random), length = 1 + random.next_below(random.next_below(4) ? 8 : 200);
    switch (random.next_below(reader.is_text ? 10 : 8)) {
        case 0:
            if (!bytes.empty()) bytes[at] ^= std::byte(1u << random.next_below(8));
            break;
        case 1:
        case 2:
            change_word(bytes, random);
            break;
        case 3:
            bytes.resize(at);
            break;
        case 4:
            replace(bytes, at, length, "");
            break;
        case 5: {  // a piece stands once more elsewhere
            const Bytes piece(bytes.begin() + long(at),
                              bytes.begin() + long(std::min(at + length, bytes.size())));
            bytes.insert(bytes.begin() + long(place_in(bytes, random)), piece.begin(), piece.end());
            break;
        }
        case 6:
            replace(bytes, at, random.next_below(3),
                    k_tokens[random.next_below(uint32_t(std::size(k_tokens)))]);
            break;
        default:
            replace_token(bytes, random);
    }
}

}  // namespace

Bytes mutate(const Reader& reader, const Bytes& seed, Random& random) {
    Bytes bytes = seed;
    for (uint32_t changes = 1 + random.next_below(4); changes > 0; --changes) change(reader, bytes, random);
    if (reader.seal && random.next_below(4) > 0) reader.seal(bytes);
    return bytes;
}

}  // namespace coppice::hostile
