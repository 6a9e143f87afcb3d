#include "tools/coppice/bench_shadows.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include "tools/coppice/figure.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_loop.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

constexpr std::pair<ShadowKind, const char*> k_kinds[] = {{ShadowKind::none, "none"},
                                                          {ShadowKind::uniform, "uniform"},
                                                          {ShadowKind::perspective, "perspective"},
                                                          {ShadowKind::light_space, "light space"},
                                                          {ShadowKind::clipmap, "clipmap"}};
constexpr uint32_t k_flight_frames = 60, k_sweep_frames = 41;
constexpr float k_degree = 3.14159265f / 180.0f;
constexpr float k_sweep_step = 0.05f * k_degree;  // of turns of the view and of the sun, rad
constexpr float k_walk_step_m = 0.05f;
constexpr double k_most_step = 1.5;  // of the median one

double shadow_passes_ms(const PlayRecord& record, const FrameRecord& frame) {
    double ms = 0.0;
    for (size_t pass = 0; pass < record.passes.size() && pass < frame.pass_ms.size(); ++pass)
        if (record.passes[pass].starts_with("shadow")) ms += frame.pass_ms[pass];
    return ms;
}

// From one frame of a sweep to the next, root mean square over the picture's bytes.
struct Steps {
    double median, largest_over_median;
};

class Sweeps {
  public:
    Sweeps(PlayHost& host, ShadowKind kind) : host_(host) { settings_.shadows = kind; }

    // frame_at(i) sets the camera and, on the host, the light of frame i.
    template <class FrameAt>
    Result<Steps> over(FrameAt&& frame_at) {
        std::vector<double> steps;
        Picture before;
        for (uint32_t i = 0; i < k_sweep_frames; ++i) {
            const Camera camera = frame_at(i);
            COPPICE_TRY(const PlayHost::FrameTimes times, host_.draw_frame(camera, settings_));
            (void)times;
            COPPICE_TRY(Picture picture, host_.read_picture());
            if (i > 0) steps.push_back(difference(before, picture));
            before = std::move(picture);
        }
        const double middle = median(steps);
        return Steps{middle, middle > 0.0 ? *std::ranges::max_element(steps) / middle : 1.0};
    }

  private:
    static double difference(const Picture& a, const Picture& b) {
        double sum = 0.0;
        for (size_t i = 0; i < a.rgba.size(); ++i) {
            const double step = (double(a.rgba[i]) - double(b.rgba[i])) / 255.0;
            sum += step * step;
        }
        return std::sqrt(sum / double(std::max<size_t>(a.rgba.size(), 1)));
    }

    PlayHost& host_;
    FrameSettings settings_;
};

Result<std::vector<Figure>> sweep(PlayHost& host, const std::string& scene) {
    std::vector<Figure> figures;
    Camera start = camera_at(host.scene.camera_path, 0.0);
    const Light light = host.scene.light;
    const vec3 sun = light.direction_to_sun;
    const float to_sun_rad = std::atan2(-sun.x, -sun.z), height_rad = std::asin(glm::clamp(sun.y, -1.0f, 1.0f));
    // Straight into the sun, and at its opposite on the ground: the singular angles of warped maps.
    const auto turn = [&](float yaw_rad, float pitch_rad) {
        return [=, &host](uint32_t i) {
            host.vegetation->set_light(light);
            Camera camera = start;
            camera.yaw_rad = yaw_rad + (float(i) - 0.5f * float(k_sweep_frames - 1)) * k_sweep_step;
            camera.pitch_rad = pitch_rad;
            return camera;
        };
    };
    const auto walk = [&](uint32_t i) {
        host.vegetation->set_light(light);
        Camera camera = start;
        camera.position_world -= dvec3(std::sin(start.yaw_rad), 0.0, std::cos(start.yaw_rad)) * double(k_walk_step_m * float(i));
        return camera;
    };
    const auto day = [&](uint32_t i) {
        Light moved = light;
        const float angle = float(i) * k_sweep_step, cosine = std::cos(angle), sine = std::sin(angle);
        moved.direction_to_sun = vec3(sun.x * cosine - sun.y * sine, sun.x * sine + sun.y * cosine, sun.z);
        host.vegetation->set_light(moved);
        return start;
    };
    for (auto [kind, name] : k_kinds) {
        Sweeps sweeps(host, kind);
        const auto add = [&](const char* what, Steps steps, std::optional<double> most) {
            const std::string prefix = fmt::format("{} {}, {}: ", scene, name, what);
            figures.push_back({prefix + "step", steps.median, "", {}});
            figures.push_back({prefix + "largest / median", steps.largest_over_median, "times", most, Reach::at_most});
        };
        COPPICE_TRY(const Steps across, sweeps.over(turn(to_sun_rad + 90.0f * k_degree, -0.1f)));
        add("turn across the sun", across, k_most_step);
        COPPICE_TRY(const Steps into, sweeps.over(turn(to_sun_rad, std::min(height_rad, 0.3f))));
        add("turn into the sun", into, k_most_step);
        COPPICE_TRY(const Steps away, sweeps.over(turn(to_sun_rad + 180.0f * k_degree, -height_rad)));
        add("turn at its opposite", away, k_most_step);
        COPPICE_TRY(const Steps walked, sweeps.over(walk));
        add("walk", walked, k_most_step);
        COPPICE_TRY(const Steps moved, sweeps.over(day));
        // Maps that stay follow it in steps of their own.
        add("sun", moved, {});
    }
    return figures;
}

}  // namespace

Result<nlohmann::json> bench_shadows(const BenchSettings& settings) {
    std::vector<Figure> figures;
    std::vector<std::string> scenes{"pines", "palms", "landscape", "sunflowers"};
    if (!settings.scene.empty()) scenes = {settings.scene};
    for (const std::string& scene : scenes) {
        PlayOptions options;
        options.scene = scene.ends_with(".json") ? scene : fmt::format("{}/scenes/{}.eco.json", settings.content, scene);
        options.headless = true;
        options.device = settings.device;
        options.cache_dir = settings.cache_dir;
        options.pictures = std::string("0");
        options.frames = k_flight_frames;
        options.width = 795;
        options.height = 700;
        COPPICE_TRY(const std::unique_ptr<PlayHost> host, PlayHost::create(options));
        const double duration_s = host->scene.camera_path.back().time_s;
        if (duration_s > 0.0) options.fps = double(k_flight_frames - 1) / duration_s;
        for (auto [kind, name] : k_kinds) {
            options.settings.shadows = kind;
            COPPICE_TRY(const PlayRecord record, play_headless(*host, options));
            std::vector<double> wall_ms, maps_ms, maps;
            for (const FrameRecord& frame : record.frames) {
                wall_ms.push_back(frame.wall_ms);
                maps_ms.push_back(shadow_passes_ms(record, frame));
                maps.push_back(double(frame.report.shadow_maps));
            }
            const auto mean = [](const std::vector<double>& values) {
                double sum = 0.0;
                for (double value : values) sum += value;
                return sum / double(std::max<size_t>(values.size(), 1));
            };
            const std::string prefix = fmt::format("{} {}: ", scene, name);
            figures.push_back({prefix + "median", 1000.0 / std::max(median(wall_ms), 1e-6), "Hz", 20.0});
            figures.push_back({prefix + "frame, p95", quantile(wall_ms, 0.95), "ms", {}});
            if (kind == ShadowKind::none) continue;
            figures.push_back({prefix + "maps drawn", mean(maps), "a frame", {}});
            figures.push_back({prefix + "maps, mean", mean(maps_ms), "ms", {}});
            figures.push_back({prefix + "maps, most", *std::ranges::max_element(maps_ms), "ms", {}});
            figures.push_back({prefix + "maps' share", mean(maps_ms) / std::max(mean(wall_ms), 1e-6), "", 0.35,
                               Reach::at_most});
        }
        COPPICE_CHECK(host->resize(400, 350));
        COPPICE_TRY(const std::vector<Figure> swept, sweep(*host, scene));
        figures.insert(figures.end(), swept.begin(), swept.end());
    }
    nlohmann::json list = nlohmann::json::array();
    for (const Figure& figure : figures) list.push_back(to_json(figure));
    return nlohmann::json{{"name", "shadows"}, {"figures", std::move(list)}};
}

}  // namespace coppice
