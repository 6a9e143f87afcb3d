// The window's life: events, one frame after the other, closing. Its parts: tools.h, panels.h, overlay.h.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <imgui.h>
#include <backends/imgui_impl_glfw.h>
#include <fmt/format.h>
#include "editor/view/ground_pick.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "editor/window/overlay.h"
#include "editor/window/panels.h"
#include "editor/window/plant_panels.h"
#include "editor/window/window_interface.h"
#include "runtime/plugin/plugin.h"
#include "runtime/window/swapchain.h"
#include "runtime/window/window.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace coppice {
namespace {

constexpr uint32_t k_accumulate_limit = 16;
constexpr float k_handle_share = 0.02f;  // of the distance: as large as a tile's mark is to be hit
constexpr float k_coarsest_px = 4.0f;  // where frames are slow whatever they draw, plants are not given up for it
constexpr float k_walk_m_per_s = 6.0f, k_fast_factor = 6.0f, k_turn_rad_per_px = 0.004f,
                k_pitch_limit_rad = 1.55f;
constexpr double k_idle_wait_s = 0.1;
constexpr int k_awake_frames = 4;  // after the last event: panels settle over some frames

// A new scene is seen from here, so that there is ground to paint on.
constexpr dvec3 k_first_place{0.0, 28.0, 50.0};
constexpr float k_first_pitch_rad = -0.5f;

// Taken as they come: between two frames of a slow machine there may be many, and each counts.
struct KeyPress {
    int key, mods;
    bool repeated;
};
struct PointerEvent {
    vec2 at_px;
    int mods;
    bool pressed, held, released;  // the left button
};

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

class EditorWindow {
  public:
    EditorWindow(Registry& registry, Session& session, const EditorWindowSettings& settings)
        : registry_(registry), session_(session), settings_(settings) {}

    ~EditorWindow() {
        overlay_.reset();
        swapchain_ = {};
        plant_.reset();
        view_.reset();
        if (imgui_) {
            ImGui_ImplGlfw_Shutdown();
            ImGui::DestroyContext();
        }
        if (window_) glfwDestroyWindow(window_);
    }

    Status start() {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
        window_ = glfwCreateWindow(int(settings_.width), int(settings_.height), "Coppice", nullptr, nullptr);
        if (!window_)
            return fail(ErrorId::device_missing, "", "glfwCreateWindow", "no window",
                        "run a script: --script FILE");
        float display_scale = 1.0f, ignored = 1.0f;
        glfwGetWindowContentScale(window_, &display_scale, &ignored);
        state_.scale = std::clamp(settings_.scale > 0.0f ? settings_.scale : display_scale, 0.5f, 4.0f);
        state_.dark = !settings_.light;
        state_.recovering = session_.recoverable_count() > 0;
        state_.warnings = session_.take_warnings();

        EditorViewSettings view;
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        view.width = uint32_t(std::max(width, 1));
        view.height = uint32_t(std::max(height, 1));
        view.cache_dir = settings_.cache_dir;
        view.device = settings_.device;
        view.validation = settings_.validation;
        uint32_t count = 0;
        const char** names = glfwGetRequiredInstanceExtensions(&count);
        view.present_extensions.assign(names, names + (names ? count : 0));
        COPPICE_TRY(view_, EditorView::create(registry_, session_, view));
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(view_->device->instance, window_, nullptr, &surface) != VK_SUCCESS)
            return fail(ErrorId::device_missing, "", "glfwCreateWindowSurface",
                        view_->device->name + " cannot draw into this window", "run a script: --script FILE");
        COPPICE_TRY(swapchain_, Swapchain::create(*view_->device, surface));

        ImGui::CreateContext();
        imgui_ = true;
        ImGui::GetIO().IniFilename = nullptr;  // panels have their places
        glfwSetWindowUserPointer(window_, this);
        queue_events();
        ImGui_ImplGlfw_InitForVulkan(window_, true);  // goes on to call what is there
        glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) {
            static_cast<EditorWindow*>(glfwGetWindowUserPointer(window))->swapchain_.invalidate();
        });
        load_fonts(state_.scale);
        apply_theme(state_.dark, state_.scale);
        COPPICE_TRY(overlay_, Overlay::create(*view_->device, view_->width, view_->height));

        const auto& json = session_.document().root().text->json;
        camera_ = camera_at(view_->camera_path(), 0.0);
        if (!json.contains("camera_path")) {
            camera_.position_world = k_first_place;
            camera_.position_world.y += ground_height(session_.terrain(), k_first_place.x, k_first_place.z);
            camera_.yaw_rad = 0.0f;
            camera_.pitch_rad = k_first_pitch_rad;
        }
        tools_.crown_width_m = [this](const std::string& kind) { return view_->crown_width_m(kind); };
        if (const auto plants = json.find("plants");
            plants != json.end() && plants->is_object() && !plants->empty())
            tools_.choose(plants->begin().key());
        state_.shadows = !view_->device->limits.is_cpu;
        settings_of_frame_.sample_distance_px = view_->sample_distance_px();
        settings_of_frame_.accumulate_limit = k_accumulate_limit;
        settings_of_frame_.time_budget_ms = state_.target_ms;
        settings_of_frame_.most_sample_distance_px = k_coarsest_px;
        if (session_.document().root().is_made_up) COPPICE_CHECK(open_plant(tools_.active));
        return {};
    }

    Status run() {
        double last_ms = now_ms();
        int awake = k_awake_frames;
        while (!state_.closed) {
            if (awake > 0)
                glfwPollEvents();
            else
                glfwWaitEventsTimeout(k_idle_wait_s);
            if (glfwWindowShouldClose(window_)) ask_to_close();
            int width = 0, height = 0;
            glfwGetFramebufferSize(window_, &width, &height);
            if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) || width < 1 || height < 1) {
                tools_.stop(session_);
                glfwWaitEventsTimeout(k_idle_wait_s);
                last_ms = now_ms();
                continue;
            }
            COPPICE_CHECK(fit(uint32_t(width), uint32_t(height)));
            const double begin_ms = now_ms();
            const float step_s = float(std::min(begin_ms - last_ms, 250.0) * 1e-3);
            last_ms = begin_ms;
            COPPICE_CHECK(frame(step_s));
            const double frame_ms = now_ms() - begin_ms;
            figures_.frame_ms = figures_.frame_ms > 0.0 ? 0.9 * figures_.frame_ms + 0.1 * frame_ms : frame_ms;
            awake = is_busy() ? k_awake_frames : awake - 1;
        }
        return {};
    }

  private:
    static EditorWindow& of(GLFWwindow* window) {
        return *static_cast<EditorWindow*>(glfwGetWindowUserPointer(window));
    }

    void queue_events() {
        glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int mods) {
            if (action != GLFW_RELEASE) of(window).presses_.push_back({key, mods, action == GLFW_REPEAT});
        });
        glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int mods) {
            if (button != GLFW_MOUSE_BUTTON_LEFT) return;
            double x = 0.0, y = 0.0;
            glfwGetCursorPos(window, &x, &y);
            const bool down = action == GLFW_PRESS;
            of(window).left_down_ = down;
            of(window).pointer_.push_back({vec2(float(x), float(y)), mods, down, down, !down});
        });
        glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
            if (of(window).left_down_)
                of(window).pointer_.push_back({vec2(float(x), float(y)), 0, false, true, false});
        });
    }

    // Whether the next frame would differ without an event.
    bool is_busy() const {
        const ImGuiIO& io = ImGui::GetIO();
        if (plant_ && (plant_->work().is_cooking() || plant_->work().is_measuring())) return true;
        return moved_ || io.MouseDown[0] || io.MouseDown[1] || io.WantTextInput ||
               (!plant_ && view_->vegetation->report().rested_frames < k_accumulate_limit);
    }

    Status fit(uint32_t width, uint32_t height) {
        if (width == view_->width && height == view_->height) return {};
        COPPICE_CHECK(view_->resize(width, height));
        if (plant_) COPPICE_CHECK(plant_->stage().resize(width, height));
        return overlay_->resize(width, height);
    }

    Status open_plant(const std::string& population) {
        tools_.stop(session_);
        const BaseSceneSettings& base = view_->base_settings();
        PlantWork::Settings work{base.cache_dir, settings_.device, base.modeller, base.find_images()};
        COPPICE_TRY(plant_, PlantEditor::open(registry_, session_, population, *view_->device, work, view_->width,
                                            view_->height));
        return {};
    }

    void ask_to_close() {
        tools_.stop(session_);
        glfwSetWindowShouldClose(window_, GLFW_FALSE);
        if (session_.saved())
            state_.closed = true;
        else
            state_.closing = true;
    }

    void save() {
        tools_.stop(session_);
        state_.overwriting = !session_.document().changed_elsewhere().empty();
        if (state_.overwriting) return;
        const Status saved = session_.save();
        state_.note = saved ? "saved" : to_string(saved.error());
    }

    void set_scale(float scale) {
        state_.scale = std::clamp(scale, 0.5f, 4.0f);
        load_fonts(state_.scale);
        apply_theme(state_.dark, state_.scale);
        if (Status uploaded = overlay_->upload_fonts(); !uploaded) state_.note = to_string(uploaded.error());
    }

    void handle_keys() {
        confirmed_ = cancelled_ = false;
        scale_by_ = 1.0f;
        const bool elsewhere = ImGui::GetIO().WantTextInput || state_.is_asking();
        for (const KeyPress& press : std::exchange(presses_, {}))
            if (!elsewhere) handle_key(press);
    }

    void handle_key(const KeyPress& press) {
        const bool shift = press.mods & GLFW_MOD_SHIFT;
        const float factor = press.key == GLFW_KEY_RIGHT_BRACKET  ? 1.15f
                             : press.key == GLFW_KEY_LEFT_BRACKET ? 1.0f / 1.15f
                                                                  : 1.0f;
        if (shift)
            tools_.brush.density_per_m2 = std::clamp(tools_.brush.density_per_m2 * factor, 0.001f, 20.0f);
        else
            tools_.brush.radius_m = std::clamp(tools_.brush.radius_m * factor, 0.2f, 100.0f);
        if (press.repeated) return;
        if (press.mods & GLFW_MOD_CONTROL) return handle_control_key(press.key, shift);
        if (plant_) {
            state_.wants_scene = press.key == GLFW_KEY_ESCAPE && !session_.document().root().is_made_up;
            return;
        }
        switch (press.key) {
            case GLFW_KEY_B:
                return take(Tool::brush);
            case GLFW_KEY_P:
                return take(Tool::polygon);
            case GLFW_KEY_T:
                return take(Tool::place);
            case GLFW_KEY_V:
                return take(Tool::select);
            case GLFW_KEY_F1:
                state_.help = !state_.help;
                return;
            case GLFW_KEY_DELETE:
                if (tools_.selected_tile()) return tools_.act_on_tile(session_, "remove_tile", nlohmann::json::object());
                return tools_.act_on_selection(session_, "delete", nlohmann::json::object());
            case GLFW_KEY_ENTER:
            case GLFW_KEY_KP_ENTER:
                confirmed_ = true;
                return;
            case GLFW_KEY_ESCAPE:
                cancelled_ = true;
                return;
            default:
                break;
        }
        const auto& json = session_.document().root().text->json;
        const auto plants = json.find("plants");
        if (plants == json.end() || !plants->is_object() || press.key < GLFW_KEY_1 || press.key > GLFW_KEY_9)
            return;
        int key = GLFW_KEY_1;
        for (const auto& [name, ignored] : plants->items())
            if (key++ == press.key) tools_.choose(name);
    }

    void handle_control_key(int key, bool shift) {
        if (key == GLFW_KEY_S) save();
        if (key == GLFW_KEY_Q) ask_to_close();
        if (key == GLFW_KEY_EQUAL || key == GLFW_KEY_KP_ADD) scale_by_ *= 1.15f;
        if (key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT) scale_by_ /= 1.15f;
        if (key != GLFW_KEY_Z && key != GLFW_KEY_Y) return;
        tools_.stop(session_);
        tools_.forget_selection();
        const bool forward = key == GLFW_KEY_Y || shift;
        const std::string name = forward ? session_.redo() : session_.undo();
        state_.note = name.empty() ? "nothing to do" : (forward ? "done again: " : "undone: ") + name;
    }

    void take(Tool tool) {
        if (tools_.tool != tool) tools_.stop(session_);
        tools_.tool = tool;
    }

    void fly(float step_s) {
        const ImGuiIO& io = ImGui::GetIO();
        const Camera before = camera_;
        if (!io.WantTextInput && !io.KeyCtrl) {
            auto axis = [&](int forward, int back) {
                return float(io.KeysDown[forward]) - float(io.KeysDown[back]);
            };
            const vec3 move = camera_.forward() * axis(GLFW_KEY_W, GLFW_KEY_S) +
                              camera_.right() * axis(GLFW_KEY_D, GLFW_KEY_A) +
                              vec3(0.0f, axis(GLFW_KEY_E, GLFW_KEY_Q), 0.0f);
            camera_.position_world +=
                dvec3(move * (k_walk_m_per_s * (io.KeyShift ? k_fast_factor : 1.0f) * step_s));
        }
        if (!io.WantCaptureMouse) {
            if (io.MouseDown[1]) {
                camera_.yaw_rad -= io.MouseDelta.x * k_turn_rad_per_px;
                camera_.pitch_rad = std::clamp(camera_.pitch_rad - io.MouseDelta.y * k_turn_rad_per_px,
                                               -k_pitch_limit_rad, k_pitch_limit_rad);
            }
            if (io.MouseWheel != 0.0f) {
                const float away_m =
                    figures_.cursor ? float(glm::length(*figures_.cursor - camera_.position_world)) : 20.0f;
                camera_.position_world +=
                    dvec3(camera_.forward() * (0.12f * io.MouseWheel * std::clamp(away_m, 2.0f, 200.0f)));
            }
        }
        moved_ = !(camera_ == before);
    }

    void handle_pointer(ViewSize size) {
        const bool blocked = state_.is_asking();
        const bool in_view = !ImGui::GetIO().WantCaptureMouse && !blocked;
        for (const PointerEvent& event : std::exchange(pointer_, {})) {
            Gesture gesture;
            gesture.ground = pick_ground(camera_, size, event.at_px, session_.terrain());
            if (gesture.ground)
                gesture.handle_m = double(k_handle_share) * glm::length(*gesture.ground - camera_.position_world);
            gesture.pressed = event.pressed && in_view;
            gesture.held = event.held;
            gesture.released = event.released;
            gesture.shift = event.mods & GLFW_MOD_SHIFT;
            gesture.control = event.mods & GLFW_MOD_CONTROL;
            gesture.alt = event.mods & GLFW_MOD_ALT;
            if (!blocked) tools_.handle(session_, gesture);
        }
        Gesture keys;
        keys.confirmed = confirmed_;
        keys.cancelled = cancelled_;
        if (confirmed_ || cancelled_) tools_.handle(session_, keys);
    }

    void draw_on_ground(const std::vector<dvec2>& points, bool closed, ImU32 color) const {
        ImDrawList* list = ImGui::GetBackgroundDrawList();
        const ViewSize size{float(view_->width), float(view_->height)};
        std::optional<vec2> before;
        const size_t count = points.size() + (closed && !points.empty() ? 1 : 0);
        for (size_t i = 0; i < count; ++i) {
            const dvec2 p = points[i % points.size()];
            const auto at =
                project(camera_, size, {p.x, ground_height(session_.terrain(), p.x, p.y) + 0.05, p.y});
            if (at && before)
                list->AddLine({before->x, before->y}, {at->x, at->y}, color, 1.5f * state_.scale);
            before = at;
        }
    }

    // A square on the ground at each of the root's tiles, and its name.
    void draw_tile_marks() const {
        const std::vector<TileHandle> handles = tile_handles(session_);
        const ViewSize size{float(view_->width), float(view_->height)};
        for (size_t i = 0; i < handles.size(); ++i) {
            const bool is_selected = tools_.selected_tile() == i;
            const dvec2 at = handles[i].at + (is_selected ? tools_.dragged() : dvec2(0.0));
            const dvec3 ground(at.x, ground_height(session_.terrain(), at.x, at.y), at.y);
            const double reach_m = double(k_handle_share) * glm::length(ground - camera_.position_world);
            const ImU32 color = is_selected ? IM_COL32(120, 220, 255, 255) : IM_COL32(255, 240, 120, 255);
            draw_on_ground({at + dvec2(-reach_m, 0), at + dvec2(0, -reach_m), at + dvec2(reach_m, 0), at + dvec2(0, reach_m)}, true,
                           color);
            const auto mark = project(camera_, size, ground);
            if (!mark) continue;
            const float apart = 24.0f * state_.scale, edge = 3.0f * state_.scale;
            const ImVec2 text = ImGui::CalcTextSize(handles[i].scene.c_str());
            const ImVec2 begin(mark->x + apart, mark->y - 0.5f * text.y), end(begin.x + text.x, begin.y + text.y);
            ImDrawList* list = ImGui::GetBackgroundDrawList();
            list->AddRectFilled({begin.x - edge, begin.y}, {end.x + edge, end.y + edge}, IM_COL32(0, 0, 0, 140), edge);
            list->AddText(begin, color, handles[i].scene.c_str());
        }
    }

    void draw_marks() const {
        const ImU32 color = ImGui::GetIO().KeyShift || ImGui::GetIO().KeyCtrl ? IM_COL32(255, 90, 60, 255)
                                                                              : IM_COL32(255, 240, 120, 255);
        if (tools_.tool == Tool::brush && figures_.cursor && !ImGui::GetIO().WantCaptureMouse) {
            std::vector<dvec2> circle;
            for (int i = 0; i < 48; ++i) {
                const float angle = 2.0f * k_pi * float(i) / 48.0f;
                circle.emplace_back(figures_.cursor->x + double(tools_.brush.radius_m * portable_cos(angle)),
                                    figures_.cursor->z + double(tools_.brush.radius_m * portable_sin(angle)));
            }
            draw_on_ground(circle, true, color);
        }
        if (tools_.tool == Tool::polygon) draw_on_ground(tools_.polygon(), true, color);
        if (tools_.tool == Tool::select) draw_tile_marks();
        if (tools_.tool == Tool::select && tools_.selected()) {
            const PlacedPlant& plant = *tools_.selected();
            const dvec2 at = ground_place(plant) + tools_.dragged();
            const Box bounds = view_->bounds_of(plant, session_.document());
            const double reach_m = std::max(0.3, 0.5 * double(std::max(bounds.size().x, bounds.size().z)) *
                                                     double(unpack_scale(plant.scale)));
            draw_on_ground({at + dvec2(-reach_m, -reach_m), at + dvec2(reach_m, -reach_m),
                            at + dvec2(reach_m, reach_m), at + dvec2(-reach_m, reach_m)},
                           true, IM_COL32(120, 220, 255, 255));
        }
    }

    void note_warnings() {
        for (Error& warning : session_.take_warnings()) {
            state_.note = to_string(warning);
            state_.warnings.push_back(std::move(warning));
        }
    }

    // Drawn, shown and waited for.
    Status present(const gpu::CommandRing::Frame& drawn, const gpu::Buffer& picture) {
        overlay_->record(drawn.commands, picture, ImGui::GetDrawData());
        COPPICE_CHECK(swapchain_.present(view_->ring, drawn.commands, overlay_->pixels(),
                                         {view_->width, view_->height}, {view_->width, view_->height}));
        return view_->ring.wait(drawn.serial);
    }

    void walk_around() {
        const ImGuiIO& io = ImGui::GetIO();
        StageView& view = plant_->view;
        moved_ = false;
        if (io.WantCaptureMouse) return;
        if (io.MouseDown[1]) {
            view.yaw_rad -= io.MouseDelta.x * k_turn_rad_per_px;
            view.pitch_rad =
                std::clamp(view.pitch_rad - io.MouseDelta.y * k_turn_rad_per_px, -k_pitch_limit_rad, k_pitch_limit_rad);
        }
        view.zoom = std::clamp(view.zoom * std::exp2(0.15f * io.MouseWheel), 0.1f, 20.0f);
        moved_ = io.MouseDown[1] || io.MouseWheel != 0.0f;
    }

    Status plant_frame() {
        handle_keys();
        pointer_.clear();
        walk_around();
        plant_->follow(session_);
        draw_plant_panels(session_, *plant_, state_);
        if (std::exchange(state_.wants_save, false)) save();
        note_warnings();
        ImGui::Render();
        const FreeColumns free = plant_free_columns(state_.scale);
        COPPICE_TRY(const gpu::CommandRing::Frame drawn,
                    plant_->stage().begin_frame(view_->ring, plant_->view, free.low_px, free.high_px));
        COPPICE_CHECK(present(drawn, plant_->stage().vegetation().color()));
        if (std::exchange(state_.wants_scene, false)) plant_.reset();
        return {};
    }

    Status frame(float step_s) {
        overlay_->begin_frame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        if (plant_) {
            COPPICE_CHECK(plant_frame());
        } else {
            COPPICE_CHECK(scene_frame(step_s));
        }
        show_title();
        // Fonts are made anew before anything of the next frame refers to them.
        if (scale_by_ != 1.0f) set_scale(state_.scale * scale_by_);
        return {};
    }

    Status scene_frame(float step_s) {
        const ImGuiIO& io = ImGui::GetIO();
        const ViewSize size{float(view_->width), float(view_->height)};
        fly(step_s);
        figures_.cursor = pick_ground(camera_, size, {io.MousePos.x, io.MousePos.y}, session_.terrain());
        handle_keys();
        handle_pointer(size);
        draw_marks();
        draw_panels(session_, tools_, *view_, figures_, state_);
        if (std::exchange(state_.wants_save, false)) save();
        note_warnings();
        ImGui::Render();

        if (Status followed = view_->follow(session_); !followed) state_.note = to_string(followed.error());
        settings_of_frame_.shadows = state_.shadows ? ShadowKind::clipmap : ShadowKind::none;
        const double begin_ms = now_ms();
        COPPICE_TRY(const gpu::CommandRing::Frame drawn, view_->begin_frame(camera_, settings_of_frame_));
        COPPICE_CHECK(present(drawn, view_->vegetation->color()));
        view_->tell_frame_ms(now_ms() - begin_ms);
        const FrameReport& report = view_->vegetation->report();
        figures_.sample_distance_px = report.sample_distance_px;
        figures_.vertices = report.vertices;
        update_shares();
        if (const std::string plant = std::exchange(state_.wants_plant, {}); !plant.empty())
            if (Status opened = open_plant(plant); !opened) state_.note = to_string(opened.error());
        return {};
    }

    // What each population costs, now and then: it takes as long as a frame's levels of detail.
    void update_shares() {
        constexpr double k_every_ms = 500.0;
        if (now_ms() - shares_ms_ < k_every_ms) return;
        const FrameExplanation drawn = view_->vegetation->explain_frame();
        shares_ms_ = now_ms();
        std::map<std::string, double> vertices;
        double far = 0.0, all = 0.0;
        for (const ExplainedPlants& plants : drawn.plants) vertices[plants.model] += double(vertices_of(plants.drawn));
        for (const ExplainedCloud& cloud : drawn.clouds) far += double(vertices_of(cloud.drawn));
        all = far;
        for (const auto& [name, count] : vertices) all += count;
        if (!(all > 0.0)) all = 1.0;
        for (auto& [name, count] : vertices) count /= all;
        figures_.shares = std::move(vertices);
        figures_.cloud_share = far / all;
    }

    void show_title() {
        const Document& document = session_.document();
        const std::string scene = std::filesystem::path(document.root_path()).filename().string();
        // A plant by itself lies in a scene that nobody named.
        std::string title = (document.root().is_made_up ? plant_->population() : scene) +
                            (session_.saved() ? "" : " *") + " - Coppice";
        if (title == title_) return;
        title_ = std::move(title);
        glfwSetWindowTitle(window_, title_.c_str());
    }

    Registry& registry_;
    Session& session_;
    const EditorWindowSettings& settings_;
    GLFWwindow* window_ = nullptr;
    std::unique_ptr<EditorView> view_;
    std::unique_ptr<PlantEditor> plant_;  // in place of the scene
    Swapchain swapchain_;
    std::unique_ptr<Overlay> overlay_;
    bool imgui_ = false;
    Tools tools_;
    PanelState state_;
    ViewFigures figures_;
    double shares_ms_ = -1e9;  // when they were updated
    Camera camera_;
    FrameSettings settings_of_frame_;
    std::vector<KeyPress> presses_;
    std::vector<PointerEvent> pointer_;
    bool left_down_ = false, confirmed_ = false, cancelled_ = false;
    float scale_by_ = 1.0f;
    bool moved_ = true;
    std::string title_;
};

Status run_window(Registry& registry, Session& session, const EditorWindowSettings& settings) {
    if (!Window::display_available())
        return fail(ErrorId::device_missing, "", "", "there is no display",
                    "set DISPLAY, or run a script: --script FILE");
    EditorWindow window(registry, session, settings);
    COPPICE_CHECK(window.start());
    return window.run();
}

const EditorWindowInterface k_interface{sizeof(EditorWindowInterface), &Window::display_available,
                                        &run_window};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_editor_window_interface, k_editor_window_version, &k_interface);
}

const CoppicePlugin k_plugin{
    sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "editor_window", COPPICE_VERSION, load, nullptr};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
