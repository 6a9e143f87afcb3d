#include "runtime/window/window.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>
#include <gtest/gtest.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include "runtime/gpu/vulkan.h"

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

// What the virtual display holds at a pixel of the window: 0xRRGGBB; its framebuffer is a file in XWD format.
uint32_t displayed(GLFWwindow* window, int x, int y) {
    const char* folder = std::getenv("WINDOW_TEST_FRAMEBUFFER");
    std::ifstream file(std::string(folder) + "/Xvfb_screen0", std::ios::binary);
    std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    auto field = [&bytes](size_t index) {
        const uint8_t* b = bytes.data() + index * 4;
        return uint32_t(b[0]) << 24 | uint32_t(b[1]) << 16 | uint32_t(b[2]) << 8 | b[3];
    };
    if (bytes.size() < 100 || field(11) != 32) return ~0u;
    int left = 0, top = 0;
    glfwGetWindowPos(window, &left, &top);
    size_t at = field(0) + field(19) * 12 + size_t(top + y) * field(12) + size_t(left + x) * 4;
    if (at + 4 > bytes.size()) return ~0u;
    return uint32_t(bytes[at + 2]) << 16 | uint32_t(bytes[at + 1]) << 8 | bytes[at];
}

TEST_F(Windows, show_the_colours_they_are_given) {
    if (!std::getenv("WINDOW_TEST_FRAMEBUFFER")) GTEST_SKIP() << "the display's framebuffer is not a file";
    for (uint32_t rgba : {0xff204080u, 0xffc08010u}) {
        uint32_t rgb = (rgba & 0xff) << 16 | (rgba & 0xff00) | (rgba >> 16 & 0xff);
        auto there = [&] {
            show_now(rgba);
            return displayed(native(), 10, 10) == rgb && displayed(native(), 309, 189) == rgb;
        };
        EXPECT_TRUE(wait_until(there)) << std::hex << rgb << " became " << displayed(native(), 10, 10);
    }
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

// Through the display's server, as a person's keys and mouse come.
TEST_F(Windows, take_keys_wheel_and_mouse) {
    if (std::system("command -v xdotool >/dev/null") != 0) GTEST_SKIP() << "no xdotool";
    show_now(0xff202020);
    glfwFocusWindow(native());
    if (!wait_until([&] { return glfwGetWindowAttrib(native(), GLFW_FOCUSED) == GLFW_TRUE; }))
        GTEST_SKIP() << "no window manager that gives the focus";
    int x = 0, y = 0;
    glfwGetWindowPos(native(), &x, &y);
    auto run = [](const std::string& command) { return std::system(("xdotool " + command).c_str()) == 0; };
    Input seen{};
    auto gather_until = [&](auto condition) {
        for (int i = 0; i < 100 && !condition(); i++) {
            Input input = window->poll();
            for (size_t k = 0; k < size_t(Key::count); k++) {
                seen.down[k] = input.down[k];
                seen.pressed[k] |= input.pressed[k];
            }
            seen.mouse_dx_px += input.mouse_dx_px;
            seen.mouse_dy_px += input.mouse_dy_px;
            seen.wheel += input.wheel;
            if (!condition()) window->wait_events();
        }
        return condition();
    };
    auto down = [&](Key key) { return seen.down[size_t(key)]; };
    auto pressed = [&](Key key) { return seen.pressed[size_t(key)]; };

    ASSERT_TRUE(run("keydown w"));
    EXPECT_TRUE(gather_until([&] { return down(Key::w) && pressed(Key::w); }));
    ASSERT_TRUE(run("keyup w"));
    EXPECT_TRUE(gather_until([&] { return !down(Key::w); }));
    ASSERT_TRUE(run("key F2"));  // down and up between two polls is still a press
    EXPECT_TRUE(gather_until([&] { return pressed(Key::f2); }));
    EXPECT_FALSE(pressed(Key::s));

    ASSERT_TRUE(run("mousemove " + std::to_string(x + 100) + " " + std::to_string(y + 100)));
    ASSERT_TRUE(run("mousemove_relative 30 0"));
    int polls = 0;
    gather_until([&] { return polls++ > 6; });  // no button is held
    EXPECT_EQ(seen.mouse_dx_px, 0.0f);
    ASSERT_TRUE(run("mousedown 3"));
    EXPECT_TRUE(wait_until([&] { return glfwGetInputMode(native(), GLFW_CURSOR) == GLFW_CURSOR_DISABLED; }));
    ASSERT_TRUE(run("mousemove_relative 20 10"));
    EXPECT_TRUE(gather_until([&] { return seen.mouse_dx_px > 0.0f && seen.mouse_dy_px > 0.0f; }));
    ASSERT_TRUE(run("mouseup 3"));
    EXPECT_TRUE(wait_until([&] { return glfwGetInputMode(native(), GLFW_CURSOR) == GLFW_CURSOR_NORMAL; }));
    ASSERT_TRUE(run("click 4"));
    EXPECT_TRUE(gather_until([&] { return seen.wheel > 0.0f; }));
}

TEST_F(Windows, say_when_they_are_to_close) {
    EXPECT_FALSE(window->poll().close_requested);
    glfwSetWindowShouldClose(native(), GLFW_TRUE);
    EXPECT_TRUE(window->poll().close_requested);
}

}  // namespace
}  // namespace coppice
