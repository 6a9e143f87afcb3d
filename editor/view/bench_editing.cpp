#include "editor/view/bench_editing.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace coppice {
namespace {

constexpr int k_repeats = 5;
constexpr int k_frames = 600, k_plants_a_frame = 167;  // 100,000 plants, in 30 s at 20 Hz
constexpr double k_brush_radius_m = 6.0, k_frame_target_ms = 33.0;

double ms_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double median_of(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

void print_row(const char* what, const std::string& measured, const char* asked) {
    fmt::print("{:<58}{:>14}{:>14}\n", what, measured, asked);
    std::fflush(stdout);
}

using Json = nlohmann::json;

Json paint_of(const std::string& kind, Json stroke, double radius_m, double density_per_m2, int seed) {
    Json shares;
    shares[kind] = 1;
    Json scatter;
    scatter["plants"] = std::move(shares);
    scatter["density_per_m2"] = density_per_m2;
    scatter["seed"] = seed;
    Json arguments;
    arguments["stroke"] = std::move(stroke);
    arguments["radius_m"] = radius_m;
    arguments["scatter"] = std::move(scatter);
    return arguments;
}

// About `count` plants along 80 m, beside those of other numbers.
Json line_of(const std::string& kind, double count, int number) {
    const double radius_m = 10.0, length_m = 80.0, z = 40.0 * number;
    const double area_m2 = 2.0 * radius_m * length_m + double(k_pi) * radius_m * radius_m;
    Json stroke = Json::array();
    for (double x = 0.0; x <= length_m; x += radius_m) stroke.push_back(Json::array({x, z}));
    return paint_of(kind, std::move(stroke), radius_m, count / area_m2, number);
}

Status bench_strokes(const std::string& folder) {
    const std::string path = folder + "/bench.eco.json";
    COPPICE_TRY(const std::unique_ptr<Session> session, Session::open(path, {}));
    COPPICE_TRY([[maybe_unused]] const Edit* added,
                session->perform("add_population", {{"name", "grass"}, {"source", "grass.json"}}));
    std::vector<double> stroke_ms, undo_ms;
    for (int i = 0; i < k_repeats; ++i) {
        auto clock = std::chrono::steady_clock::now();
        COPPICE_TRY([[maybe_unused]] const Edit* painted,
                    session->perform("paint", line_of("grass", 5000.0, i)));
        stroke_ms.push_back(ms_since(clock));
        clock = std::chrono::steady_clock::now();
        session->undo();
        undo_ms.push_back(ms_since(clock));
        session->redo();
    }
    const size_t count = session->document().root().plants.size();
    COPPICE_CHECK(session->save());
    std::error_code failed;
    const auto size_bytes = std::filesystem::file_size(session->document().root().placed_path, failed);
    if (failed || count == 0)
        return fail(ErrorId::write_failed, folder, "", "holds no saved plants",
                    "set TMPDIR to a folder with room");
    print_row("stroke of 5,000 plants, with the journal", fmt::format("{:.1f} ms", median_of(stroke_ms)),
              "50 ms");
    print_row("undo of it, likewise", fmt::format("{:.1f} ms", median_of(undo_ms)), "50 ms");
    print_row("saved plant", fmt::format("{:.1f} bytes", double(size_bytes) / double(count)), "20 bytes");
    return {};
}

Status draw(EditorView& view, Session& session, const Camera& camera) {
    const auto clock = std::chrono::steady_clock::now();
    COPPICE_CHECK(view.follow(session));
    FrameSettings settings;
    settings.shadows = ShadowKind::none;
    settings.sample_distance_px = view.sample_distance_px();
    settings.time_budget_ms = float(k_frame_target_ms);
    COPPICE_TRY(const gpu::CommandRing::Frame frame, view.begin_frame(camera, settings));
    COPPICE_CHECK(view.ring.submit());
    COPPICE_CHECK(view.ring.wait(frame.serial));
    view.tell_frame_ms(ms_since(clock));
    return {};
}

// The population with the smallest crowns: what is painted by the hundred thousand.
std::string smallest_population(const EditorView& view, const Session& session) {
    std::string smallest;
    const auto& json = session.document().root().text->json;
    if (const auto plants = json.find("plants"); plants != json.end() && plants->is_object())
        for (const auto& [name, ignored] : plants->items())
            if (smallest.empty() || view.crown_width_m(name) < view.crown_width_m(smallest)) smallest = name;
    return smallest;
}

Status bench_view(Registry& registry, const TerrainInterface* terrain, const std::string& scene_path,
                  const EditorViewSettings& settings) {
    const auto clock = std::chrono::steady_clock::now();
    COPPICE_TRY(const std::unique_ptr<Session> session, Session::open(scene_path, {terrain, false}));
    const double read_ms = ms_since(clock);
    COPPICE_TRY(const std::unique_ptr<EditorView> view, EditorView::create(registry, *session, settings));
    const Camera camera = camera_at(view->camera_path(), 0.0);
    COPPICE_CHECK(draw(*view, *session, camera));
    print_row("opened, to the first frame", fmt::format("{:.0f} ms", ms_since(clock)), "2000 ms");
    const EditorView::Times& times = view->times();
    fmt::print("  of that: files {:.0f}, scene {:.0f}, plants {:.0f}, tiles {:.0f}, upload {:.0f} ms\n",
               read_ms, times.scene_ms, times.plants_ms, times.tiles_ms, times.upload_ms);
    std::fflush(stdout);

    const std::string kind = smallest_population(*view, *session);
    if (kind.empty()) return {};
    const dvec3 ahead = camera.position_world + dvec3(camera.forward()) * 40.0;
    std::vector<double> frame_ms;
    for (int i = 0; i < k_frames; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        const double x = ahead.x + 4.0 * (i % 25 - 12), z = ahead.z + 4.0 * (i / 25 - 12);
        const double density = k_plants_a_frame / (double(k_pi) * k_brush_radius_m * k_brush_radius_m);
        Json stroke = Json::array();
        stroke.push_back(Json::array({x, z}));
        const Json dab = paint_of(kind, std::move(stroke), k_brush_radius_m, density, i);
        COPPICE_TRY([[maybe_unused]] const Edit* painted, session->perform("paint", dab));
        COPPICE_CHECK(draw(*view, *session, camera));
        frame_ms.push_back(ms_since(begin));
    }
    const size_t count = session->document().root().plants.size();
    std::sort(frame_ms.begin(), frame_ms.end());
    print_row(fmt::format("{} of '{}' painted, {} frames: median", count, kind, k_frames).c_str(),
              fmt::format("{:.0f} Hz", 1000.0 / frame_ms[frame_ms.size() / 2]), "20 Hz");
    print_row("  slowest twentieth", fmt::format("{:.0f} Hz", 1000.0 / frame_ms[frame_ms.size() * 19 / 20]),
              "20 Hz");
    return {};
}

}  // namespace

Status bench_editing(Registry& registry, const TerrainInterface* terrain, const std::string& scene_path,
                     const EditorViewSettings& settings) {
    print_row("editing", "measured", "asked");
    std::error_code failed;
    std::string folder = (std::filesystem::temp_directory_path(failed) / "coppice_bench_XXXXXX").string();
    if (failed || !::mkdtemp(folder.data()))
        return fail(ErrorId::write_failed, folder, "", "cannot be made", "set TMPDIR to a folder with room");
    const Status strokes = bench_strokes(folder);
    std::filesystem::remove_all(folder, failed);
    COPPICE_CHECK(strokes);
    return bench_view(registry, terrain, scene_path, settings);
}

}  // namespace coppice
