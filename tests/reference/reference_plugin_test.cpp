// The module as its users have it: loaded by name, used through its interface.
#include <cstdlib>
#include <gtest/gtest.h>
#include "runtime/plugin/registry.h"
#include "tools/reference/reference.h"

namespace coppice {

TEST(ReferencePlugin, TracesThroughItsInterface) {
    ::setenv("COPPICE_PLUGIN_PATH", REFERENCE_MODULE_DIR, 1);
    Registry registry;
    const Status loaded = registry.load("reference");
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    const auto* reference = registry.find<ReferenceInterface>(k_reference_interface, k_reference_version);
    ASSERT_NE(reference, nullptr);
    EXPECT_EQ(reference->size_bytes, sizeof(ReferenceInterface));

    auto rays = reference->create(Scene{}, {}, nullptr);
    ASSERT_TRUE(rays) << to_string(rays.error());
    EXPECT_EQ((*rays)->triangle_count(), 0u);
    ReferenceSettings settings;
    settings.width = 3;
    settings.height = 2;
    settings.samples_per_pixel = 1;
    auto picture = (*rays)->trace(Camera{}, settings);
    ASSERT_TRUE(picture) << to_string(picture.error());
    EXPECT_EQ(picture->shadowed.rgb.size(), 18u);
    EXPECT_GT(picture->shadowed.rgb[0], 0.0f);
    rays->reset();  // before the module that it belongs to
}

}  // namespace coppice
