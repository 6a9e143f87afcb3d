#include "tools/coppice/bench_accuracy.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "runtime/core/file.h"
#include "runtime/core/log.h"
#include "runtime/core/progress.h"
#include "tools/accuracy/accuracy_figures.h"
#include "tools/accuracy/accuracy_page.h"
#include "tools/accuracy/accuracy_record.h"
#include "tools/accuracy/accuracy_summary.h"
#include "tools/accuracy/accuracy_tables.h"
#include "tools/accuracy/flip.h"
#include "tools/accuracy/reference_cache.h"
#include "tools/coppice/machine.h"
#include "tools/coppice/method_drawer.h"
#include "tools/coppice/play_options.h"

namespace coppice {
namespace {

constexpr uint32_t k_spread_views = 5;  // of a path, where a scene has no views of its own
constexpr double k_pop_step = 1.03;     // of the quality, from frame to frame
constexpr uint32_t k_pop_steps = 36;    // from 0.7 to 2 times the default quality
constexpr uint32_t k_shimmer_frames = 6;
constexpr double k_shimmer_step_px = 0.125;
constexpr uint32_t k_resting_frames = 64, k_resting_growth = 4;
constexpr double k_resting_limit_ms = 8000.0;  // of one measurement
constexpr uint32_t k_temporal_views = 2;

Result<std::vector<std::unique_ptr<AccuracyMethod>>> choose_methods(const std::string& wanted) {
    std::vector<std::unique_ptr<AccuracyMethod>> all = make_accuracy_methods(), chosen;
    std::vector<std::string> names;
    for (const auto& method : all) names.push_back(method->name());
    std::vector<bool> take(all.size(), wanted.empty());
    take[0] = true;  // every triangle: what all others are compared with
    for (size_t at = 0; at < wanted.size();) {
        const size_t end = std::min(wanted.find(';', at), wanted.size());
        const std::string name = wanted.substr(at, end - at);
        bool known = false;
        // A part of a name takes all methods that have it.
        for (size_t i = 0; i < all.size(); ++i)
            if (names[i].find(name) != std::string::npos) known = take[i] = true;
        if (!known || name.empty())
            return fail(
                ErrorId::name_unknown, "", "--methods", fmt::format("no method is called '{}'", name),
                fmt::format("names or parts of them, with ; between, of: {}", fmt::join(names, "; ")));
        at = end + 1;
    }
    for (size_t i = 0; i < all.size(); ++i)
        if (take[i]) chosen.push_back(std::move(all[i]));
    return chosen;
}

// A black-body gradient: dark where nothing differs.
Picture heat_picture(const std::vector<float>& values, uint32_t width, uint32_t height) {
    constexpr float k_anchors[][3] = {{0.0f, 0.0f, 0.02f},
                                      {0.30f, 0.06f, 0.43f},
                                      {0.72f, 0.21f, 0.33f},
                                      {0.98f, 0.55f, 0.04f},
                                      {0.99f, 1.0f, 0.64f}};
    constexpr float k_last = float(std::size(k_anchors) - 1);
    Picture picture{width, height, std::vector<uint8_t>(values.size() * 4, 255)};
    for (size_t i = 0; i < values.size(); ++i) {
        const float at = std::clamp(values[i], 0.0f, 1.0f) * k_last;
        const size_t below = std::min(size_t(at), std::size(k_anchors) - 2);
        for (size_t c = 0; c < 3; ++c) {
            const float value =
                k_anchors[below][c] + (k_anchors[below + 1][c] - k_anchors[below][c]) * (at - float(below));
            picture.rgba[4 * i + c] = uint8_t(value * 255.0f + 0.5f);
        }
    }
    return picture;
}

std::string file_name(const std::string& text) {
    std::string name;
    for (char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.';
        if (plain)
            name += c;
        else if (!name.empty() && name.back() != '-')
            name += '-';
    }
    return name;
}

// "content/scenes/pines.eco.json" -> "pines".
std::string scene_stem(const std::string& path) {
    std::string name = std::filesystem::path(path).filename().string();
    return name.substr(0, name.find('.'));
}

class AccuracyBench {
  public:
    // settings.out and settings.cache_dir are not empty; settings outlive it.
    explicit AccuracyBench(const BenchSettings& settings) : settings_(settings) {}

    Result<AccuracyRecord> run() {
        COPPICE_CHECK(load());
        COPPICE_CHECK(trace_references());
        Stopwatch clock;
        for (const auto& method : methods_) {
            COPPICE_CHECK(method->prepare({&original_, settings_.cache_dir, modeller_, images_}));
        }
        for (uint32_t view = 0; view < record_.views.size(); ++view) COPPICE_CHECK(sweep(view));
        COPPICE_CHECK(measure_motion());
        COPPICE_CHECK(rest());
        record_.duration_s = clock.ms() * 1e-3;
        record_.figures = accuracy_figures(record_);
        return std::move(record_);
    }

  private:
    Status load() {
        PlayOptions options;
        options.scene =
            settings_.scene.find('/') == std::string::npos && settings_.scene.find('.') == std::string::npos
                ? fmt::format("{}/scenes/{}.eco.json", settings_.content, settings_.scene)
                : settings_.scene;
        COPPICE_CHECK(parse_size("--size", settings_.size, options.width, options.height));
        options.headless = true;
        options.keep_scene = true;
        options.device = settings_.device;
        options.cache_dir = settings_.cache_dir;
        COPPICE_TRY(methods_, choose_methods(settings_.methods));
        COPPICE_TRY(host_, PlayHost::create(options));
        if (host_->plant_count == 0)
            return fail(
                ErrorId::value_out_of_range, options.scene, "placements", "a scene without plants",
                "levels of detail are of plants: name a scene that has some, such as pines or woodland");
        original_ = {host_->scene, host_->plants};
        drawer_.emplace(*host_);
        images_ = host_->find_images();
        modeller_ = host_->registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
        if (!images_)
            return fail(ErrorId::name_unknown, "", "plugin images", "is not installed",
                        "the references are kept by it: install it beside the program");
        COPPICE_CHECK(host_->registry.load("reference"));
        tracer_ = host_->registry.find<ReferenceInterface>(k_reference_interface, k_reference_version);
        if (!tracer_)
            return fail(ErrorId::name_unknown, "", "plugin reference", "does not provide its interface",
                        "install the module of this version");
        COPPICE_CHECK(load_views(options.scene));

        record_.scene_name = original_.scene.name;
        record_.width = options.width;
        record_.height = options.height;
        record_.device = host_->device->name;
        record_.driver = host_->device->driver;
        record_.machine = describe_machine().processor;
        record_.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
        record_.plants = host_->plant_count;
        for (const auto& method : methods_) {
            AccuracyMethodRecord entry{method->name(), method->what(), method->quality_name()};
            entry.default_quality = method->default_quality();
            entry.is_default = entry.name == k_default_method;
            record_.methods.push_back(entry);
        }
        return {};
    }

    // Keys of --views, of content/paths/SCENE_views.json, or five places along the scene's own path.
    Status load_views(const std::string& scene_path) {
        std::string path = settings_.views;
        if (path.empty()) {
            const std::string own =
                fmt::format("{}/paths/{}_views.json", settings_.content, scene_stem(scene_path));
            if (std::filesystem::exists(own)) path = own;
        }
        std::vector<CameraKey> keys;
        if (!path.empty()) {
            COPPICE_TRY(keys, load_camera_path(path, original_.scene.terrain.get()));
        } else {
            const std::vector<CameraKey>& flight = original_.scene.camera_path;
            const double first_s = flight.front().time_s, last_s = flight.back().time_s;
            const uint32_t count = last_s > first_s ? k_spread_views : 1;
            for (uint32_t i = 0; i < count; ++i) {
                const double time_s =
                    first_s + (last_s - first_s) * double(i) / double(std::max(count - 1, 1u));
                keys.push_back({time_s, camera_at(flight, time_s)});
            }
        }
        for (const CameraKey& key : keys) {
            views_.push_back(key.camera);
            const dvec3& at = key.camera.position_world;
            record_.views.push_back(
                {fmt::format("view {}: at {:.0f}, {:.0f}, {:.0f} m", views_.size(), at.x, at.y, at.z), "",
                 0.0});
        }
        return {};
    }

    Status trace_references() {
        ReferenceCache cache({&original_.scene, original_.plants, host_->bare_terrain.get(), tracer_, images_,
                              settings_.cache_dir});
        ReferenceSettings settings;
        settings.width = record_.width;
        settings.height = record_.height;
        settings.show_progress = true;
        for (size_t view = 0; view < views_.size(); ++view) {
            COPPICE_TRY(const ReferencePicture traced, cache.find_or_trace(views_[view], settings));
            record_.reference_samples = traced.samples_per_pixel;
            Truths truths;
            // Frames come in 8 bits: what they cannot hold must not count as their error.
            const Picture shadowed = encode_srgb(display_light(traced.shadowed, original_.scene.light));
            const Picture unshadowed = encode_srgb(display_light(traced.unshadowed, original_.scene.light));
            truths.shadowed.display = decode_srgb(shadowed);
            truths.unshadowed.display = decode_srgb(unshadowed);
            double sum = 0.0;
            for (size_t i = 0; i < traced.coverage.rgb.size(); i += 3) {
                truths.shadowed.coverage.push_back(traced.coverage.rgb[i]);
                sum += double(traced.coverage.rgb[i]);
            }
            truths.unshadowed.coverage = truths.shadowed.coverage;
            record_.views[view].plant_coverage = sum / double(truths.shadowed.coverage.size());
            record_.views[view].reference_file = fmt::format("view{}-reference.png", view + 1);
            COPPICE_CHECK(images_->write(settings_.out + "/" + record_.views[view].reference_file, shadowed));
            COPPICE_CHECK(
                images_->write(fmt::format("{}/view{}-unshadowed.png", settings_.out, view + 1), unshadowed));
            truths_.push_back(std::move(truths));
        }
        return {};
    }

    Result<AccuracySample> measure(uint32_t method_index, uint32_t view, double quality,
                                   FloatPicture* display) {
        AccuracyMethod& method = *methods_[method_index];
        COPPICE_TRY(const DrawnFrame drawn, method.frame(views_[view], focal_px(views_[view]), quality));
        COPPICE_TRY(const MethodDrawer::Timing timing, drawer_->time(drawn, views_[view]));
        const uint32_t frames = method.samples_per_pixel();
        record_.scene_triangles = host_->vegetation->report().scene_triangles;
        COPPICE_TRY(MeasuredFrame frame, drawer_->measure(drawn, views_[view], frames));
        AccuracySample sample{};
        sample.method = method_index;
        sample.view = view;
        sample.quality = quality;
        sample.frame_ms = timing.frame_ms * double(frames);
        sample.triangles = timing.triangles * frames;
        sample.lines = timing.lines * frames;
        sample.points = timing.points * frames;
        sample.geometry_bytes = timing.geometry_bytes;
        sample.list_bytes = timing.list_bytes;
        COPPICE_TRY(sample.errors, measure_errors(frame, truths_[view].shadowed, *images_));
        COPPICE_TRY(sample.unshadowed_errors, measure_errors(frame, truths_[view].unshadowed, *images_));
        *display = std::move(frame.display);
        return sample;
    }

    Status sweep(uint32_t view) {
        size_t steps = 0;
        for (const auto& method : methods_) steps += method->qualities().size();
        Progress progress(fmt::format("{} of {}", record_.views[view].name, record_.views.size()), steps);
        const size_t first = record_.samples.size();
        std::vector<FloatPicture> pictures;
        for (uint32_t m = 0; m < methods_.size(); ++m)
            for (double quality : methods_[m]->qualities()) {
                pictures.emplace_back();
                COPPICE_TRY(const AccuracySample sample, measure(m, view, quality, &pictures.back()));
                record_.samples.push_back(sample);
                progress.advance(1);
            }
        return keep_pictures(view, first, pictures);
    }

    // Of each method the setting nearest in time to the default's; of the default method its default, too.
    Status keep_pictures(uint32_t view, size_t first, const std::vector<FloatPicture>& pictures) {
        const uint32_t by_default = default_method(record_);
        double default_ms = 0.0;
        for (size_t i = first; i < record_.samples.size(); ++i) {
            const AccuracySample& sample = record_.samples[i];
            if (sample.method == by_default && sample.quality == record_.methods[by_default].default_quality)
                default_ms = sample.frame_ms;
        }
        for (uint32_t m = 0; m < methods_.size(); ++m) {
            size_t nearest = 0;
            double least = INFINITY;
            for (size_t i = first; i < record_.samples.size(); ++i) {
                const AccuracySample& sample = record_.samples[i];
                const double away =
                    std::fabs(std::log(std::max(sample.frame_ms, 1e-6) / std::max(default_ms, 1e-6)));
                if (sample.method == m && away < least) {
                    least = away;
                    nearest = i;
                }
            }
            AccuracySample& sample = record_.samples[nearest];
            const FloatPicture& display = pictures[nearest - first];
            const std::string stem = fmt::format("view{}-{}", view + 1, file_name(record_.methods[m].name));
            COPPICE_TRY(const std::vector<float> flip, flip_map(display, truths_[view].shadowed.display));
            sample.picture_file = stem + ".png";
            sample.flip_file = stem + "-flip.png";
            COPPICE_CHECK(images_->write(settings_.out + "/" + sample.picture_file, encode_srgb(display)));
            COPPICE_CHECK(images_->write(settings_.out + "/" + sample.flip_file,
                                         heat_picture(flip, display.width, display.height)));
        }
        return {};
    }

    // Pops while the level of detail changes under a still camera, shimmer while the camera turns slowly.
    Status measure_motion() {
        std::vector<uint32_t> views = spread_frames(k_temporal_views, uint32_t(views_.size()));
        Progress progress("pops and shimmer", methods_.size());
        for (uint32_t m = 0; m < methods_.size(); ++m) {
            AccuracyMethod& method = *methods_[m];
            progress.advance(1);
            if (method.samples_per_pixel() > 1) continue;
            double pop = 0.0, shimmer = 0.0;
            for (uint32_t view : views) {
                if (!method.quality_name().empty()) {
                    COPPICE_TRY(const double energy, pop_energy(method, views_[view]));
                    pop += energy / double(views.size());
                }
                COPPICE_TRY(const double rms, shimmer_rms(method, views_[view]));
                shimmer += rms / double(views.size());
            }
            if (!method.quality_name().empty()) record_.methods[m].pop_energy = pop;
            record_.methods[m].shimmer = shimmer;
        }
        return {};
    }

    Result<double> pop_energy(AccuracyMethod& method, const Camera& camera) {
        PopEnergy energy;
        FloatPicture before;
        double quality = method.default_quality() / std::pow(k_pop_step, double(k_pop_steps) / 3.0);
        for (uint32_t step = 0; step < k_pop_steps; ++step, quality *= k_pop_step) {
            COPPICE_TRY(const DrawnFrame drawn, method.frame(camera, focal_px(camera), quality));
            COPPICE_TRY(FloatPicture now, drawer_->picture(drawn, camera, 1));
            if (step > 0) COPPICE_CHECK(energy.add(before, now));
            before = std::move(now);
        }
        return energy.energy();
    }

    Result<double> shimmer_rms(AccuracyMethod& method, Camera camera) {
        Shimmer shimmer;
        for (uint32_t i = 0; i < k_shimmer_frames; ++i) {
            COPPICE_TRY(const DrawnFrame drawn,
                        method.frame(camera, focal_px(camera), method.default_quality()));
            COPPICE_TRY(const FloatPicture picture, drawer_->picture(drawn, camera, 1));
            COPPICE_CHECK(shimmer.add(picture));
            camera.yaw_rad += float(k_shimmer_step_px) / focal_px(camera);
        }
        return shimmer.rms();
    }

    // The default method while nothing moves: 1, 4, 16 ... frames.
    Status rest() {
        AccuracyMethod& method = *methods_[default_method(record_)];
        Progress progress("a view at rest", views_.size());
        for (uint32_t view = 0; view < views_.size(); ++view) {
            COPPICE_TRY(const DrawnFrame drawn,
                        method.frame(views_[view], focal_px(views_[view]), method.default_quality()));
            double last_ms = 0.0;
            for (uint32_t frames = 1;
                 frames <= k_resting_frames && last_ms * k_resting_growth < k_resting_limit_ms;
                 frames *= k_resting_growth) {
                Stopwatch clock;
                COPPICE_TRY(const MeasuredFrame frame, drawer_->measure(drawn, views_[view], frames));
                last_ms = clock.ms() / 2.0;  // the mask takes as long
                AccuracyRecord::Resting resting{view, frames, last_ms, {}, {}};
                COPPICE_TRY(resting.errors, measure_errors(frame, truths_[view].shadowed, *images_));
                COPPICE_TRY(resting.unshadowed_errors,
                            measure_errors(frame, truths_[view].unshadowed, *images_));
                record_.resting.push_back(resting);
            }
            progress.advance(1);
        }
        return {};
    }

    float focal_px(const Camera& camera) const {
        return make_frustum(camera, record_.width, record_.height).focal_px;
    }

    static constexpr const char* k_default_method = "hybrid, measured";

    struct Truths {
        MeasuredFrame shadowed, unshadowed;
    };

    const BenchSettings& settings_;
    std::unique_ptr<PlayHost> host_;
    std::vector<std::unique_ptr<AccuracyMethod>> methods_;
    MethodScene original_;
    std::optional<MethodDrawer> drawer_;
    const ImagesInterface* images_ = nullptr;
    const ModellerInterface* modeller_ = nullptr;
    const ReferenceInterface* tracer_ = nullptr;
    std::vector<Camera> views_;
    std::vector<Truths> truths_;
    AccuracyRecord record_;
};

}  // namespace

Result<nlohmann::json> bench_accuracy(const BenchSettings& asked) {
    BenchSettings settings = asked;
    if (settings.scene.empty()) settings.scene = "pines";
    if (settings.out.empty()) settings.out = "out/accuracy-" + scene_stem(settings.scene);
    if (settings.cache_dir.empty()) settings.cache_dir = default_cache_dir();
    COPPICE_TRY(AccuracyRecord record, AccuracyBench(settings).run());
    record.command = command_line();
    const nlohmann::json json = accuracy_json(record);
    COPPICE_CHECK(write_text_file(settings.out + "/accuracy.json", json.dump(2) + "\n"));
    COPPICE_CHECK(write_text_file(settings.out + "/accuracy.csv", accuracy_csv(record)));
    COPPICE_CHECK(write_text_file(settings.out + "/index.html", accuracy_page(record)));
    fmt::print("{0}/index.html  {0}/accuracy.json  {0}/accuracy.csv\n", settings.out);
    return json;
}

}  // namespace coppice
