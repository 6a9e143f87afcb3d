// Components of the tests.
#pragma once
#include <cstdint>

namespace coppice::test {

struct Position {
    static constexpr const char* k_component_name = "test_position";
    float x = 0, y = 0, z = 0;
    bool operator==(const Position&) const = default;
};
struct Velocity {
    static constexpr const char* k_component_name = "test_velocity";
    float x = 0, y = 0, z = 0;
    bool operator==(const Velocity&) const = default;
};
struct Age {
    static constexpr const char* k_component_name = "test_age";
    uint64_t steps = 0;
    bool operator==(const Age&) const = default;
};
struct Frozen {
    static constexpr const char* k_component_name = "test_frozen";
};
struct Tile {
    static constexpr const char* k_component_name = "test_tile";
    uint32_t visible = 0;
    uint32_t number = 0;
};
struct Cached {
    static constexpr const char* k_component_name = "test_cached";
    static constexpr bool k_component_hashed = false;
    uint32_t value = 0;
};

}  // namespace coppice::test
