// The name of an entity: a place in a table and how often that place was given away before.
#pragma once
#include <compare>
#include <cstdint>

namespace coppice {

// A handle of a destroyed entity stays dead for ever: its index comes back only with a higher generation, and
// an index whose generations are used up never comes back.
struct Entity {
    uint32_t index = 0;
    uint32_t generation = 0;  // 0: no entity, or one that Commands will create

    explicit operator bool() const { return generation != 0; }
    uint64_t bits() const { return uint64_t(generation) << 32 | index; }
    static Entity from_bits(uint64_t bits) { return {uint32_t(bits), uint32_t(bits >> 32)}; }
    friend auto operator<=>(const Entity&, const Entity&) = default;
};

}  // namespace coppice
