#include <gtest/gtest.h>
#include "runtime/ecs/component.h"
#include "tests/ecs/components.h"

namespace coppice {
namespace {
using namespace test;

struct SamePosition {
    static constexpr const char* k_component_name = "test_position";
    float values[3];
};
struct OtherPosition {
    static constexpr const char* k_component_name = "test_position";
    double x;
};

TEST(Component, NameDecidesTheId) {
    EXPECT_EQ(component_id<Position>(), component_id<SamePosition>());
    EXPECT_EQ(component_id<Position>(), component_id<const Position>());
    EXPECT_NE(component_id<Position>(), component_id<Velocity>());
    EXPECT_EQ(component_info(component_id<Position>()).name, "test_position");
}

TEST(Component, TagsTakeNoBytes) {
    EXPECT_EQ(component_info(component_id<Frozen>()).size_bytes, 0u);
    EXPECT_EQ(component_info(component_id<Age>()).size_bytes, 8u);
    EXPECT_FALSE(component_info(component_id<Cached>()).hashed);
}

TEST(ComponentDeathTest, AnotherStructOfTheSameNameEndsTheProgram) {
    component_id<Position>();
    EXPECT_DEATH(component_id<OtherPosition>(), "component 'test_position' is registered");
}

// Other compilers cannot tell.
#if defined(__GNUC__) && !defined(__clang__)
struct Padded {
    static constexpr const char* k_component_name = "test_padded";
    uint8_t small;
    uint32_t large;
};

TEST(ComponentDeathTest, HashedPaddingEndsTheProgram) {
    EXPECT_DEATH(component_id<Padded>(), "component 'test_padded' is hashed but has padding");
}
#endif

}  // namespace
}  // namespace coppice
