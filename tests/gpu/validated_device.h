// A device under the validation layer, whose silence every test ends with.
#pragma once
#include <memory>
#include <gtest/gtest.h>
#include "runtime/gpu/device.h"

namespace coppice::gpu {

class ValidatedDevice : public testing::Test {
  protected:
    void SetUp() override {
        DeviceSettings settings;
        settings.validation = true;
        auto made = Device::create(settings);
        ASSERT_TRUE(made) << to_string(made.error());
        device = std::move(*made);
    }
    void TearDown() override {
        if (device) {
            EXPECT_EQ(device->validation_messages(), 0u);
        }
    }
    std::unique_ptr<Device> device;
};

}  // namespace coppice::gpu
