#include "runtime/window/window.h"

#include <fmt/format.h>
#include "runtime/window/swapchain.h"
#include "runtime/gpu/vulkan.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace coppice {
namespace {

std::string g_last_error;  // of GLFW, which belongs to the main thread

// GLFW is started once, by whoever asks first, and ends with the process.
struct Glfw {
    bool started = false;
    Glfw() {
        glfwSetErrorCallback(
            [](int code, const char* text) { g_last_error = fmt::format("{} (GLFW {})", text, code); });
        started = glfwInit() == GLFW_TRUE;
    }
    ~Glfw() {
        if (started) glfwTerminate();
    }
};

bool start_glfw() {
    static Glfw glfw;
    return glfw.started;
}

struct Binding {
    int glfw_key;
    Key key;
};

constexpr Binding k_bindings[] = {
    {GLFW_KEY_W, Key::w},
    {GLFW_KEY_A, Key::a},
    {GLFW_KEY_S, Key::s},
    {GLFW_KEY_D, Key::d},
    {GLFW_KEY_Q, Key::q},
    {GLFW_KEY_E, Key::e},
    {GLFW_KEY_P, Key::p},
    {GLFW_KEY_R, Key::r},
    {GLFW_KEY_ESCAPE, Key::escape},
    {GLFW_KEY_SPACE, Key::space},
    {GLFW_KEY_LEFT_SHIFT, Key::shift},
    {GLFW_KEY_RIGHT_SHIFT, Key::shift},
    {GLFW_KEY_LEFT_CONTROL, Key::control},
    {GLFW_KEY_RIGHT_CONTROL, Key::control},
    {GLFW_KEY_UP, Key::up},
    {GLFW_KEY_DOWN, Key::down},
    {GLFW_KEY_LEFT, Key::left},
    {GLFW_KEY_RIGHT, Key::right},
    {GLFW_KEY_F1, Key::f1},
    {GLFW_KEY_F2, Key::f2},
    {GLFW_KEY_F3, Key::f3},
    {GLFW_KEY_EQUAL, Key::plus},  // where + is on most keyboards
    {GLFW_KEY_KP_ADD, Key::plus},
    {GLFW_KEY_MINUS, Key::minus},
    {GLFW_KEY_KP_SUBTRACT, Key::minus},
    {GLFW_KEY_LEFT_BRACKET, Key::bracket_left},
    {GLFW_KEY_RIGHT_BRACKET, Key::bracket_right},
    {GLFW_KEY_COMMA, Key::comma},
    {GLFW_KEY_PERIOD, Key::period},
};

class GlfwWindow final : public Window {
  public:
    explicit GlfwWindow(GLFWwindow* window) : window_(window) {
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
            if (action == GLFW_PRESS) self(w).press(key);
        });
        glfwSetScrollCallback(window,
                              [](GLFWwindow* w, double, double y) { self(w).input_.wheel += float(y); });
        glfwSetCursorPosCallback(window,
                                 [](GLFWwindow* w, double x, double y) { self(w).move_cursor(x, y); });
        glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int, int) { self(w).update_look(); });
        glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { self(w).update_look(); });
        glfwSetFramebufferSizeCallback(window,
                                       [](GLFWwindow* w, int, int) { self(w).swapchain_.invalidate(); });
    }
    ~GlfwWindow() override {
        swapchain_ = {};
        glfwDestroyWindow(window_);
    }
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;

    Status attach(const gpu::Device& device) override {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        VkResult result = glfwCreateWindowSurface(device.instance, window_, nullptr, &surface);
        if (result != VK_SUCCESS)
            return fail(ErrorId::device_missing, "", "glfwCreateWindowSurface",
                        fmt::format("{} cannot draw into this window: {}", device.name, g_last_error),
                        "make the device with the window's instance extensions, or run without a window");
        swapchain_ = {};  // a window has one surface at a time
        COPPICE_TRY(swapchain_, Swapchain::create(device, surface));
        return {};
    }

    Input poll() override {
        glfwPollEvents();
        Input input = input_;
        for (const Binding& binding : k_bindings)
            input.down[size_t(binding.key)] |= glfwGetKey(window_, binding.glfw_key) == GLFW_PRESS;
        input.close_requested = glfwWindowShouldClose(window_) == GLFW_TRUE;
        input_ = {};
        return input;
    }

    uint32_t width_px() const override { return drawable().width; }
    uint32_t height_px() const override { return drawable().height; }
    void wait_events() override { glfwWaitEventsTimeout(0.1); }
    void set_title(const std::string& title) override { glfwSetWindowTitle(window_, title.c_str()); }
    void* native() const override { return window_; }

    Result<bool> present(gpu::CommandRing& ring, VkCommandBuffer commands, const gpu::Buffer& pixels,
                         uint32_t width, uint32_t height) override {
        return swapchain_.present(ring, commands, pixels, {width, height}, drawable());
    }

  private:
    static GlfwWindow& self(GLFWwindow* window) {
        return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    }

    VkExtent2D drawable() const {
        if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return {0, 0};
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        return {uint32_t(width), uint32_t(height)};
    }

    void press(int glfw_key) {
        for (const Binding& binding : k_bindings)
            if (binding.glfw_key == glfw_key) input_.pressed[size_t(binding.key)] = true;
    }

    // While a button is held the cursor is hidden and may move without end.
    void update_look() {
        bool look = glfwGetWindowAttrib(window_, GLFW_FOCUSED) &&
                    (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS ||
                     glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS);
        if (look == looking_) return;
        looking_ = look;
        glfwSetInputMode(window_, GLFW_CURSOR, look ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
        glfwGetCursorPos(window_, &cursor_x_, &cursor_y_);
    }

    void move_cursor(double x, double y) {
        if (!looking_) return;
        input_.mouse_dx_px += float(x - cursor_x_);
        input_.mouse_dy_px += float(y - cursor_y_);
        cursor_x_ = x;
        cursor_y_ = y;
    }

    GLFWwindow* window_;
    Swapchain swapchain_;
    Input input_{};  // gathered since the last poll
    bool looking_ = false;
    double cursor_x_ = 0.0, cursor_y_ = 0.0;
};

}  // namespace

bool Window::display_available() { return start_glfw(); }

std::vector<const char*> Window::instance_extensions() {
    if (!start_glfw()) return {};
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return {names, names + (names ? count : 0)};
}

Result<std::unique_ptr<Window>> Window::create(const WindowSettings& settings) {
    if (!start_glfw())
        return fail(ErrorId::device_missing, "", "", "there is no display: " + g_last_error,
                    "set DISPLAY, or run without a window");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow* window =
        glfwCreateWindow(int(settings.width), int(settings.height), settings.title.c_str(), nullptr, nullptr);
    if (!window)
        return fail(ErrorId::device_missing, "", "glfwCreateWindow", "no window: " + g_last_error,
                    "run without a window");
    return std::make_unique<GlfwWindow>(window);
}

}  // namespace coppice
