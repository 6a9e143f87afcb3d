// What an entity can carry: trivially copyable structs, known by a name that is the same in every module and
// run.
//
//     struct Position { static constexpr const char* k_component_name = "position"; float x, y, z; };
//
// A struct without members is a tag: it takes no memory. A component that must stay out of World::hash() (a
// cache, a pointer) says `static constexpr bool k_component_hashed = false;`. One that is hashed must have no
// padding bytes.
#pragma once
#include <bitset>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace coppice {

inline constexpr uint32_t k_component_limit = 128;  // kinds of component in one process

// Dense, in order of first use in this process: never store it. The name is what lasts.
using ComponentId = uint32_t;
using ComponentMask = std::bitset<k_component_limit>;

// Specialise it for types of others.
template <class C>
struct ComponentTraits {
    static constexpr std::string_view name = C::k_component_name;
    static constexpr bool hashed = [] {
        if constexpr (requires { C::k_component_hashed; }) return bool(C::k_component_hashed);
        return true;
    }();
};

struct ComponentInfo {
    std::string name;
    uint64_t name_hash;
    uint32_t size_bytes;  // 0: a tag
    uint32_t alignment;
    bool hashed;
};

// The same name gives the same id, from every module. Any thread. Ends the program with a message when the
// name is already that of a struct of another size, or when there are more than k_component_limit: going on
// would overwrite memory.
ComponentId register_component(std::string_view name, uint32_t size_bytes, uint32_t alignment, bool hashed);
const ComponentInfo& component_info(ComponentId id);

namespace detail {
// Whether every byte of C is part of its value; true where the compiler cannot tell.
template <class C>
bool has_no_padding() {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
    alignas(C) unsigned char bytes[sizeof(C)];
    for (unsigned char& byte : bytes) byte = 0xff;
    __builtin_clear_padding(reinterpret_cast<C*>(bytes));
    for (unsigned char byte : bytes)
        if (byte != 0xff) return false;
#endif
#endif
    return true;
}
[[noreturn]] void end_with_padding(std::string_view name);

template <class C>
ComponentId register_type() {
    static_assert(std::is_trivially_copyable_v<C>, "components are copied and moved as bytes");
    static_assert(std::is_trivially_destructible_v<C>, "components are dropped without a destructor call");
    static_assert(alignof(C) <= 16, "columns start at multiples of 16 bytes");
    constexpr bool hashed = ComponentTraits<C>::hashed;
    constexpr uint32_t size_bytes = std::is_empty_v<C> ? 0 : uint32_t(sizeof(C));
    if (hashed && size_bytes && !has_no_padding<C>()) end_with_padding(ComponentTraits<C>::name);
    return register_component(ComponentTraits<C>::name, size_bytes, alignof(C), hashed);
}
}  // namespace detail

template <class C>
ComponentId component_id() {
    static const ComponentId id = detail::register_type<std::remove_const_t<C>>();
    return id;
}

template <class... Cs>
ComponentMask component_mask() {
    ComponentMask mask;
    (mask.set(component_id<Cs>()), ...);
    return mask;
}

}  // namespace coppice
