#include "tools/coppice/play_window.h"

#include <algorithm>
#include <fmt/format.h>
#include "plugins/vegetation/eco/populated_scene.h"
#include "runtime/core/log.h"
#include "runtime/core/watched_files.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/flown_path.h"
#include "tools/coppice/page_text.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"
#include "tools/window/window_interface.h"

namespace coppice {
namespace {

constexpr uint32_t k_accumulate_limit = 64;  // frames of a view at rest
constexpr float k_walk_m_per_s = 4.0f, k_fast_factor = 8.0f;
constexpr float k_turn_rad_per_px = 0.0025f;
constexpr float k_pitch_limit_rad = 1.55f;
constexpr double k_title_interval_ms = 250.0, k_watch_interval_ms = 500.0;
constexpr size_t k_averaged_frames = 30;

// Who flies: the scene's path until the user takes over.
struct Flight {
    Camera camera;
    double path_time_s = 0.0;
    bool on_path = true;
};

bool is_down(const Input& input, Key key) { return input.down[size_t(key)]; }
bool was_pressed(const Input& input, Key key) { return input.pressed[size_t(key)]; }

void fly(Flight& flight, const Input& input, const std::vector<CameraKey>& path, float step_s) {
    if (was_pressed(input, Key::p)) flight.on_path = !flight.on_path;
    if (was_pressed(input, Key::r)) flight = {flight.camera, 0.0, true};
    auto axis = [&](Key forward, Key back) {
        return float(is_down(input, forward)) - float(is_down(input, back));
    };
    const vec3 move = flight.camera.forward() * axis(Key::w, Key::s) +
                      flight.camera.right() * axis(Key::d, Key::a) + vec3(0.0f, axis(Key::e, Key::q), 0.0f);
    const bool steered = move != vec3(0.0f) || input.mouse_dx_px != 0.0f || input.mouse_dy_px != 0.0f;
    if (steered) flight.on_path = false;
    if (flight.on_path) {
        flight.path_time_s += step_s;
        if (flight.path_time_s > path.back().time_s) flight.path_time_s = 0.0;
        flight.camera = camera_at(path, flight.path_time_s);
        return;
    }
    const float speed_m_per_s = k_walk_m_per_s * (is_down(input, Key::shift) ? k_fast_factor : 1.0f);
    flight.camera.position_world += dvec3(move * (speed_m_per_s * step_s));
    flight.camera.yaw_rad -= input.mouse_dx_px * k_turn_rad_per_px;
    flight.camera.pitch_rad = std::clamp(flight.camera.pitch_rad - input.mouse_dy_px * k_turn_rad_per_px,
                                         -k_pitch_limit_rad, k_pitch_limit_rad);
}

void change_settings(FrameSettings& settings, const Input& input) {
    auto scale = [&](Key more, Key less, float factor) {
        return was_pressed(input, more) ? factor : was_pressed(input, less) ? 1.0f / factor : 1.0f;
    };
    settings.sample_distance_px =
        std::clamp(settings.sample_distance_px * scale(Key::plus, Key::minus, 1.1f) *
                       scale(Key::bracket_right, Key::bracket_left, 1.1f),
                   0.1f, 64.0f);
    settings.splat_factor =
        std::clamp(settings.splat_factor * scale(Key::period, Key::comma, 1.05f), 0.1f, 10.0f);
    if (was_pressed(input, Key::f2))
        settings.view =
            settings.view == RepresentationView::lit ? RepresentationView::kinds : RepresentationView::lit;
    if (was_pressed(input, Key::f3)) settings.level_of_detail = !settings.level_of_detail;
}

std::string title_of(const PlayHost& host, const FrameSettings& settings, double median_ms, bool help) {
    if (help)
        return "WASD and mouse fly, Q E down and up, shift fast | [ ] or - + sample distance, , . splat "
               "factor | "
               "P pause path, R replay | F2 kinds, F3 level of detail, F1 figures, Esc quits";
    const FrameReport& report = host.vegetation->report();
    return fmt::format(
        "{} | {:.1f} ms, {:.0f} Hz | d' {:.2f} px, c_p {:.2f}{} | {} triangles, {} leaves, {} lines, {} points",
        host.scene.name, median_ms, 1000.0 / std::max(median_ms, 1e-3), report.sample_distance_px,
        settings.splat_factor, settings.level_of_detail ? "" : ", every triangle",
        short_count(double(report.triangles)), short_count(double(report.leaves)), short_count(double(report.lines)),
        short_count(double(report.points)));
}

// Plants and scenes that were changed on disk; what is wrong is said, and the old ones stay.
void reload_changed(PlayHost& host, const PlayOptions& options, WatchedFiles& files) {
    if (!files.changed()) return;
    files.begin();
    const Status loaded = host.reload(options);
    files.end();
    if (loaded)
        log_note("{}: loaded again", options.scene);
    else
        log_error("{}; what was loaded before stays", to_string(loaded.error()));
}

const WindowInterface* find_window(Registry& registry) {
    if (!registry.load("window")) return nullptr;
    return registry.find<WindowInterface>(k_window_interface, k_window_version);
}

}  // namespace

bool window_available() {
    Registry registry;
    const WindowInterface* windows = find_window(registry);
    return windows && windows->display_available();
}

Status play_in_window(const PlayOptions& options) {
    Registry registry;
    const WindowInterface* windows = find_window(registry);
    if (!windows)
        return fail(ErrorId::name_unknown, "", "plugin window", "not installed",
                    "add --headless 1280x720 --out DIR");
    WatchedFiles files;
    files.begin();
    Result<std::unique_ptr<PlayHost>> created = PlayHost::create(options, windows->instance_extensions());
    files.end();
    COPPICE_TRY(std::unique_ptr<PlayHost> host, std::move(created));
    const bool reloads = populated_scene_file(options.scene).empty();
    COPPICE_TRY(std::unique_ptr<Window> window,
                windows->create({"Coppice: " + host->scene.name, options.width, options.height}));
    COPPICE_CHECK(window->attach(*host->device));
    // Nothing to record: the window copies the picture after the frame's last pass, which must be finished by
    // then.
    host->graph.add_pass("present", {{host->vegetation->color_resource(), BufferAccess::transfer_read}}, {});

    FrameSettings settings = options.settings;
    settings.sample_distance_px = options.sample_distance_px.value_or(host->scene.sample_distance_px);
    settings.accumulate_limit = k_accumulate_limit;
    Flight flight{camera_at(host->scene.camera_path, 0.0)};
    FlownPath flown;
    std::vector<double> recent_ms;
    size_t frame_index = 0;
    bool help = false;
    Stopwatch clock, title_clock, watch_clock;
    double last_ms = clock.ms();
    for (;;) {
        const Input input = window->poll();
        if (input.close_requested || was_pressed(input, Key::escape)) break;
        if (reloads && watch_clock.ms() > k_watch_interval_ms) {
            reload_changed(*host, options, files);
            watch_clock = {};
        }
        const uint32_t width = window->width_px(), height = window->height_px();
        if (width == 0 || height == 0) {  // minimised: draw nothing
            window->wait_events();
            last_ms = clock.ms();
            continue;
        }
        if (width != host->width || height != host->height) COPPICE_CHECK(host->resize(width, height));

        const double now_ms = clock.ms(), step_ms = now_ms - last_ms;
        last_ms = now_ms;
        if (recent_ms.size() < k_averaged_frames) recent_ms.push_back(step_ms);
        recent_ms[frame_index++ % recent_ms.size()] = step_ms;
        help ^= was_pressed(input, Key::f1);
        change_settings(settings, input);
        fly(flight, input, host->scene.camera_path, float(std::min(step_ms, 250.0) * 1e-3));
        if (!options.record.empty()) flown.add(now_ms * 1e-3, flight.camera);

        COPPICE_TRY(PlayHost::Frame frame, host->begin_frame(flight.camera, settings));
        COPPICE_CHECK(
            window->present(host->ring, frame.ring.commands, host->vegetation->color(), width, height));
        if (title_clock.ms() > k_title_interval_ms || was_pressed(input, Key::f1)) {
            window->set_title(title_of(*host, settings, median(recent_ms), help));
            title_clock = {};
        }
    }
    return options.record.empty() ? Status() : flown.write(options.record);
}

}  // namespace coppice
