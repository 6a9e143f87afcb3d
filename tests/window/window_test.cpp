#include "runtime/window/window.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <gtest/gtest.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace coppice {
namespace {

struct Windows : testing::Test {
    void SetUp() override {
        if (!Window::display_available()) GTEST_SKIP() << "no display";
        auto made = Window::create({.title = "test", .width = 320, .height = 200});
        ASSERT_TRUE(made) << to_string(made.error());
        window = std::move(*made);
        gpu::DeviceSettings settings;
        settings.validation = true;
        settings.present = true;
        settings.instance_extensions = Window::instance_extensions();
        ASSERT_FALSE(settings.instance_extensions.empty());
        auto made_device = gpu::Device::create(settings);
        ASSERT_TRUE(made_device) << to_string(made_device.error());
        device = std::move(*made_device);
        Status attached = window->attach(*device);
        ASSERT_TRUE(attached) << to_string(attached.error());
        auto made_ring = gpu::CommandRing::create(*device, 2);
        ASSERT_TRUE(made_ring);
        ring = std::move(*made_ring);
    }

    void TearDown() override {
        ring = {};
        pixels = gpu::Buffer{};
        window.reset();
        if (device) {
            EXPECT_EQ(device->validation_messages(), 0u);
        }
    }

    // Draws one colour over a picture of that size; whether it was shown.
    bool show(uint32_t width, uint32_t height, uint32_t rgba) {
        if (pixels.size_bytes() < width * height * 4ull) {
            if (ring.slots()) vkDeviceWaitIdle(device->handle);
            auto made = gpu::Buffer::create(*device, {.size_bytes = width * height * 4ull, .name = "pixels"});
            EXPECT_TRUE(made);
            pixels = std::move(*made);
        }
        auto frame = ring.begin();
        EXPECT_TRUE(frame);
        vkCmdFillBuffer(frame->commands, pixels.handle(), 0, VK_WHOLE_SIZE, rgba);
        Result<bool> shown = window->present(ring, frame->commands, pixels, width, height);
        EXPECT_TRUE(shown) << to_string(shown.error());
        return shown && *shown;
    }

    bool show_now(uint32_t rgba) {
        window->poll();
        return show(window->width_px(), window->height_px(), rgba);
    }

    // Windows change when the display's server has answered. Whether it came to be.
    template <class Condition>
    bool wait_until(Condition condition) {
        for (int i = 0; i < 100 && !condition(); i++) {
            window->wait_events();
            window->poll();
        }
        return condition();
    }

    GLFWwindow* native() { return static_cast<GLFWwindow*>(window->native()); }

    std::unique_ptr<gpu::Device> device;
    std::unique_ptr<Window> window;
    gpu::CommandRing ring;
    gpu::Buffer pixels;
};

TEST_F(Windows, show_pictures_frame_after_frame) {
    EXPECT_EQ(window->width_px(), 320u);
    EXPECT_EQ(window->height_px(), 200u);
    uint32_t shown_count = 0;
    for (uint32_t i = 0; i < 20; i++) shown_count += show_now(0xff0000ff + (i << 8));
    EXPECT_GE(shown_count, 18u);  // the first may find that the window manager has just changed the window
}

TEST_F(Windows, follow_their_size) {
    for (int i = 0; i < 5; i++) show_now(0xff00ff00);
    for (uint32_t size : {500u, 150u, 333u}) {
        glfwSetWindowSize(native(), int(size), int(size) / 2);
        ASSERT_TRUE(
            wait_until([&] { return window->width_px() == size && window->height_px() == size / 2; }));
        EXPECT_FALSE(show(size + 1, size / 2, 0));  // recorded for another size: skipped
        bool shown = false;
        for (int i = 0; i < 5; i++) shown |= show_now(0xffff0000);
        EXPECT_TRUE(shown) << size;
    }
}

TEST_F(Windows, draw_nothing_while_minimised) {
    show_now(0xffffffff);
    glfwIconifyWindow(native());
    if (!wait_until([&] { return glfwGetWindowAttrib(native(), GLFW_ICONIFIED) == GLFW_TRUE; }))
        GTEST_SKIP() << "no window manager that minimises";
    EXPECT_EQ(window->width_px(), 0u);
    EXPECT_EQ(window->height_px(), 0u);
    EXPECT_FALSE(show(320, 200, 0));
    window->wait_events();
    glfwRestoreWindow(native());
    ASSERT_TRUE(wait_until([&] { return window->width_px() > 0; }));
    bool shown = false;
    for (int i = 0; i < 5; i++) shown |= show_now(0xff808080);
    EXPECT_TRUE(shown);
}

TEST_F(Windows, say_when_they_are_to_close) {
    EXPECT_FALSE(window->poll().close_requested);
    glfwSetWindowShouldClose(native(), GLFW_TRUE);
    EXPECT_TRUE(window->poll().close_requested);
}

}  // namespace
}  // namespace coppice
