// What a program in C forgets is an answer, not a crash.
#include "plugins/vegetation/coppice.h"

#include <cstring>
#include <gtest/gtest.h>

namespace {

const CoppiceForestInterface* forest_interface() {
    return static_cast<const CoppiceForestInterface*>(
        coppice_interface(COPPICE_FOREST_INTERFACE, COPPICE_FOREST_VERSION));
}

TEST(CInterface, IsFoundByNameAndVersion) {
    ASSERT_NE(forest_interface(), nullptr);
    EXPECT_EQ(forest_interface()->size_bytes, sizeof(CoppiceForestInterface));
    EXPECT_EQ(coppice_interface(COPPICE_FOREST_INTERFACE, COPPICE_FOREST_VERSION + 1), nullptr);
    EXPECT_EQ(coppice_interface("coppice.wood", COPPICE_FOREST_VERSION), nullptr);
    EXPECT_EQ(coppice_interface(nullptr, COPPICE_FOREST_VERSION), nullptr);
}

TEST(CInterface, WhatIsMissingIsBadInputWithAMessage) {
    const CoppiceForestInterface* coppice = forest_interface();
    ASSERT_NE(coppice, nullptr);
    CoppiceForestSettings settings{};
    settings.size_bytes = sizeof settings;
    CoppiceForest* forest = nullptr;
    uint32_t number = 0;
    const CoppiceFrame frame{};
    const auto refused = [&](int result, const char* named) {
        EXPECT_EQ(result, COPPICE_BAD_INPUT) << named;
        EXPECT_NE(std::strstr(coppice->message(), named), nullptr) << coppice->message();
    };
    refused(coppice->create(&settings, nullptr), "forest");
    refused(coppice->create(nullptr, &forest), "settings");
    settings.size_bytes = 0;
    refused(coppice->create(&settings, &forest), "size");
    refused(coppice->record(nullptr, &frame), "size");
    refused(coppice->record(nullptr, nullptr), "frame");
    refused(coppice->resize(nullptr, 1, 1), "forest");
    refused(coppice->set_light(nullptr, nullptr), "forest");
    refused(coppice->reload_if_changed(nullptr, nullptr), "changed");
    refused(coppice->reload_if_changed(nullptr, &number), "forest");
    refused(coppice->add_plant(nullptr, nullptr, nullptr), "number");
    refused(coppice->move_plant(nullptr, 1, nullptr), "NULL");
    refused(coppice->remove_plant(nullptr, 1), "forest");
    coppice->destroy(nullptr);
    coppice->set_frame_ms(nullptr, 0, 1.0);
    coppice->report(nullptr, nullptr);
    coppice->scene_camera(nullptr, 0.0, nullptr);
    EXPECT_EQ(coppice->model_count(nullptr), 0u);
    EXPECT_EQ(coppice->model_name(nullptr, 0), nullptr);
    const double at[3] = {0, 0, 0};
    const float down[3] = {0, -1, 0};
    CoppiceHit hit{};
    hit.size_bytes = sizeof hit;
    coppice->first_hit(nullptr, at, down, 1.0f, &hit);
    EXPECT_EQ(hit.plant, UINT32_MAX);
    hit.plant = 3;
    coppice->nearest_stem(nullptr, nullptr, 1.0f, &hit);
    EXPECT_EQ(hit.plant, UINT32_MAX);
    coppice->nearest_stem(nullptr, at, 1.0f, nullptr);
    EXPECT_EQ(coppice->stems_in_box(nullptr, at, at, nullptr, 4, 0), 0u);
}

}  // namespace
