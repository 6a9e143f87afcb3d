// A window with a swapchain, keyboard and mouse. Its own library: headless programs never link it.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"
#include "runtime/gpu/device.h"

namespace coppice {

struct WindowSettings {
    std::string title = "Coppice";
    uint32_t width = 1280, height = 720;
};

enum class Key : uint8_t {
    w,
    a,
    s,
    d,
    q,
    e,
    p,
    r,
    escape,
    space,
    shift,
    control,
    up,
    down,
    left,
    right,
    f1,
    f2,
    f3,
    plus,
    minus,
    bracket_left,
    bracket_right,
    comma,
    period,
    count
};

// State since the last poll.
struct Input {
    bool down[size_t(Key::count)];     // held now
    bool pressed[size_t(Key::count)];  // went down since the last poll
    float mouse_dx_px, mouse_dy_px;    // movement while the right or left button is held
    float wheel;
    bool close_requested;
};

// Main thread only, as GLFW asks. Ends before the device it is attached to.
class Window {
  public:
    // false where there is no display (GLFW does not start): play then needs --headless.
    static bool display_available();
    // Instance extensions the device must be created with (DeviceSettings::instance_extensions, present =
    // true).
    static std::vector<const char*> instance_extensions();

    static Result<std::unique_ptr<Window>> create(const WindowSettings& settings);
    virtual ~Window() = default;
    // After the device exists. Requires a device made with present = true.
    virtual Status attach(const gpu::Device& device) = 0;

    virtual Input poll() = 0;
    // Drawable size; 0x0 while minimised: draw nothing then, wait_events().
    virtual uint32_t width_px() const = 0;
    virtual uint32_t height_px() const = 0;
    virtual void wait_events() = 0;  // a tenth of a second at most
    virtual void set_title(const std::string& title) = 0;
    // The GLFWwindow, for what draws or tests with GLFW itself.
    virtual void* native() const = 0;

    // Copies `pixels` (width*height RGBA8, sRGB-encoded, made by the commands recorded before this call with
    // the size given here) into the next swapchain image and presents after the ring's submit. The swapchain
    // is made again on resize; a size that no longer fits is skipped for that frame (returns false). Call
    // order: ring.begin(), record frame, present(ring, frame, ...), which submits.
    virtual Result<bool> present(gpu::CommandRing& ring, VkCommandBuffer commands, const gpu::Buffer& pixels,
                                 uint32_t width, uint32_t height) = 0;
};

}  // namespace coppice
