#include "tools/coppice/bench_scenes.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <fmt/format.h>
#include "tools/coppice/figure.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_loop.h"
#include "tools/coppice/play_report.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

constexpr uint32_t k_flight_frames = 60;  // spread over the whole path

// Flies a scene of content/scenes from its start to its end in k_flight_frames frames. Without shadows, unless they are what is
// measured: the other figures are of levels of detail.
Result<PlayRecord> fly_scene(const BenchSettings& settings, const std::string& scene, PlayOptions options,
                             ShadowKind shadows = ShadowKind::none) {
    options.settings.shadows = shadows;
    options.scene = fmt::format("{}/scenes/{}.eco.json", settings.content, scene);
    options.headless = true;
    options.device = settings.device;
    options.cache_dir = settings.cache_dir;
    options.pictures = std::string("0");  // assigned as a literal, GCC 12 warns of an overlap that cannot be
    options.frames = k_flight_frames;
    COPPICE_TRY(std::unique_ptr<PlayHost> host, PlayHost::create(options));
    const double duration_s = host->scene.camera_path.back().time_s;
    if (duration_s > 0.0) options.fps = double(k_flight_frames - 1) / duration_s;
    return play_headless(*host, options);
}

double figure_value(const std::vector<Figure>& figures, const std::string& name) {
    auto found =
        std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.name == name; });
    return found == figures.end() ? 0.0 : found->value;
}

nlohmann::json to_json(const char* name, const PlayRecord& record, const std::vector<Figure>& figures) {
    nlohmann::json list = nlohmann::json::array();
    for (const Figure& figure : figures) list.push_back(coppice::to_json(figure));
    return {{"name", name},
            {"device", record.device},
            {"machine", record.machine.processor},
            {"threads", record.machine.threads},
            {"figures", std::move(list)}};
}

}  // namespace

Result<nlohmann::json> bench_pines(const BenchSettings& settings) {
    PlayOptions options;
    options.width = 795;
    options.height = 700;
    options.compare_full = true;
    COPPICE_TRY(const PlayRecord record, fly_scene(settings, "pines", options));
    const std::vector<Figure> all = play_figures(record);
    auto value = [&](const char* name) { return figure_value(all, name); };
    return to_json("pines", record,
                   {{"median_hz", value("median_hz"), "Hz", 30.0},
                    {"median_ms", value("median_ms"), "ms", {}},
                    {"sample_distance_px", value("sample_distance_px"), "px", 1.0, Reach::at_most},
                    {"full_over_lod", value("full_over_lod"), "times", 30.0},
                    {"compared_lod_median_ms", value("compared_lod_median_ms"), "ms", {}},
                    {"compared_full_median_ms", value("compared_full_median_ms"), "ms", {}},
                    {"psnr_to_full_db", value("psnr_to_full_db"), "dB", {}},
                    {"vertices", value("vertices"), "per frame", {}},
                    {"scene_triangles", value("scene_triangles"), "", {}}});
}

Result<nlohmann::json> bench_frame(const BenchSettings& settings) {
    std::vector<Figure> figures;
    PlayRecord record;
    PlayOptions options;
    options.width = 795;
    options.height = 700;
    options.sample_distance_px = 1.0f;
    for (const char* way : {"d' as set", "budget"}) {
        COPPICE_TRY(record, fly_scene(settings, "thicket_100000", options));
        std::vector<double> cull_ms, lod_ms, write_ms, all_ms, expanded, visible, vertices;
        for (const FrameRecord& frame : record.frames) {
            const FrameReport& report = frame.report;
            cull_ms.push_back(report.cull_ms);
            lod_ms.push_back(report.lod_ms);
            write_ms.push_back(report.write_ms);
            all_ms.push_back(report.cull_ms + report.lod_ms + report.write_ms);
            expanded.push_back(report.plants_expanded);
            visible.push_back(report.plants_visible);
            vertices.push_back(double(report.vertices));
        }
        const std::string prefix = fmt::format("{}: ", way);
        figures.push_back({prefix + "cull, lod, write", median(all_ms), "ms", 1.0, Reach::at_most});
        figures.push_back({prefix + "cull: tiles, plants in view", median(cull_ms), "ms", {}});
        figures.push_back({prefix + "lod: levels, budget", median(lod_ms), "ms", {}});
        figures.push_back({prefix + "write: work list", median(write_ms), "ms", {}});
        figures.push_back({prefix + "plants in expanded tiles", median(expanded), "per frame", {}});
        figures.push_back({prefix + "plants in view", median(visible), "per frame", {}});
        figures.push_back({prefix + "vertices", median(vertices), "per frame", {}});
        // d' comes out as it was set, but has to be found.
        options.settings.vertex_budget = uint64_t(median(vertices));
        options.sample_distance_px = 0.5f;
    }
    return to_json("frame", record, figures);
}

Result<nlohmann::json> bench_table(const BenchSettings& settings) {
    std::vector<Figure> figures;
    PlayRecord last;
    for (const char* scene : {"pines", "palms", "landscape", "sunflowers"}) {
        PlayOptions options;
        options.width = 795;
        options.height = 700;
        COPPICE_TRY(last, fly_scene(settings, scene, options));
        const std::vector<Figure> all = play_figures(last);
        auto add = [&](const char* name, const char* unit, std::optional<double> reach = {}) {
            figures.push_back({fmt::format("{} {}", scene, name), figure_value(all, name), unit, reach});
        };
        add("median_hz", "Hz", 30.0);
        add("scene_triangles", "");
        add("plants", "");
        add("triangles", "per frame");
        add("lines", "per frame");
        add("points", "per frame");
        add("device_memory_mib", "MiB");
        COPPICE_TRY(const PlayRecord shadowed, fly_scene(settings, scene, options, FrameSettings{}.shadows));
        figures.push_back({fmt::format("{} median_hz with shadows", scene),
                           figure_value(play_figures(shadowed), "median_hz"), "Hz", 20.0});
    }
    return to_json("scenes", last, figures);
}

Result<nlohmann::json> bench_stand(const BenchSettings& settings) {
    // peer_ms, peer_db: the fastest peer on such a machine (docs/decisions.md), the latter its picture against its own
    // full one. compared_frames: how many are also drawn with every triangle, which takes seconds a frame.
    struct Stand {
        const char* scene;
        double peer_ms;
        uint32_t compared_frames;
        double peer_db;
    };
    constexpr Stand k_stands[] = {
        {"stand_640", 356.0, 4, 25.5}, {"stand_5000", 409.0, 2, 24.4}, {"stand_50000", 490.0, 1, 0.0}};
    std::vector<Figure> figures;
    PlayRecord last;
    for (const Stand& stand : k_stands)
        for (float sample_distance_px : {1.0f, 2.0f}) {
            PlayOptions options;
            options.compare_full = true;
            options.compare_frames = stand.compared_frames;
            options.sample_distance_px = sample_distance_px;
            COPPICE_TRY(last, fly_scene(settings, stand.scene, options));
            const std::vector<Figure> all = play_figures(last);
            double sum_ms = 0.0;
            for (const FrameRecord& frame : last.frames) sum_ms += frame.wall_ms;
            const std::string prefix = fmt::format("{} d'={} ", stand.scene, sample_distance_px);
            auto value = [&](const char* name) { return figure_value(all, name); };
            std::optional<double> reach_db;
            if (stand.peer_db > 0.0) reach_db = stand.peer_db;
            figures.push_back({prefix + "mean", sum_ms / double(last.frames.size()), "ms",
                               stand.peer_ms / 10.0, Reach::at_most});
            figures.push_back({prefix + "median", value("median_ms"), "ms", {}});
            figures.push_back({prefix + "vertices", value("vertices"), "per frame", {}});
            figures.push_back({prefix + "full / lod", value("full_over_lod"), "times", {}});
            figures.push_back({prefix + "PSNR to full", value("psnr_to_full_db"), "dB", reach_db});
        }
    return to_json("stand", last, figures);
}

}  // namespace coppice
