#include "tools/coppice/bench_scale.h"

#include <array>
#include <filesystem>
#include <fmt/format.h>
#include "plugins/vegetation/cook/cook_file.h"
#include "runtime/core/file.h"
#include "tools/accuracy/log_plot.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/page_style.h"
#include "tools/coppice/page_text.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_loop.h"
#include "tools/coppice/populate_pieces.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t k_frames = 60, k_rounds = 3;
constexpr uint64_t k_vertex_budget = 500'000;
constexpr uint32_t k_tile_memory_mib = 64;

// A wood on periodic ground, or a mosaic of the size before it.
struct Size {
    const char* name;
    uint32_t side_m;         // of a wood; else 0
    uint32_t columns, rows;  // of a mosaic
    double spacing_x_m, spacing_z_m;
};
// Ten times as many triangles each: three woods, all of whose plants differ in place and turn, then ten of the third
// beside each other, and so on.
constexpr std::array<Size, 6> k_sizes{{{"1e7", 192, 1, 1, 0, 0},
                                       {"1e8", 608, 1, 1, 0, 0},
                                       {"1e9", 1920, 1, 1, 0, 0},
                                       {"1e10", 0, 5, 2, 1920, 1920},
                                       {"1e11", 0, 2, 5, 9600, 3840},
                                       {"1e12", 0, 5, 2, 19200, 19200}}};

std::string scene_name(const Size& size) { return fmt::format("scale-{}", size.name); }

// Near the middle of the middle wood, which is that of column 2 where there are five, and of the first row of two.
struct Place {
    double x = 0.0, z = 0.0;
};
Place viewed_place(size_t index) {
    Place place;
    for (size_t i = 3; i <= index; ++i) {
        const Size& size = k_sizes[i];
        place.x += (double(size.columns / 2) - 0.5 * (size.columns - 1)) * size.spacing_x_m;
        place.z += (double(size.rows / 2) - 0.5 * (size.rows - 1)) * size.spacing_z_m;
    }
    return place;
}

// From the ground of a wood to above its trees, forward.
std::string flight_text(Place at) {
    auto key = [&](double time_s, double forward_m, double above_m) {
        return fmt::format(
            R"({{"time_s": {}, "at": [{}, {}], "above_m": {}, "look_at": [{}, {}], "look_above_m": {}}})",
            time_s, at.x, at.z - forward_m, above_m, at.x, at.z - forward_m - 80.0, 0.7 * above_m);
    };
    return fmt::format("[{}, {}, {}]", key(0, 0, 1.7), key(3, 20, 12), key(6, 60, 60));
}

std::string light_text() {
    return R"("haze": {"color": [0.5, 0.6, 0.76], "density_per_m": 0.0001}, "sample_distance_px": 1.0)";
}

std::string wood_text(const Size& size, const std::string& content) {
    auto plant = [&](const char* species, uint32_t variations, double height_m) {
        return fmt::format(R"({{"source": "{}/species/{}.json", "variations": {}, "height_m": {}}})", content,
                           species, variations, height_m);
    };
    auto scatter = [&](const char* plants, double density_per_m2, double spacing_m, int seed) {
        return fmt::format(
            R"({{"scatter": {{"plants": {}, "density_per_m2": {}, "spacing_m": {}, "region": "all", "scale": [0.7, 1.3], "seed": {}}}}})",
            plants, density_per_m2, spacing_m, seed);
    };
    return fmt::format(
        R"({{"name": "{}",
"plants": {{"pine": {}, "beech": {}, "shrub": {}}},
"regions": {{"all": {{"rectangle": {{"center": [0, 0], "size_m": [{}, {}]}}}}}},
"terrain": {{"procedural": {{"size_m": {}, "cell_m": 4, "seed": 3, "periodic": true, "amplitude_m": 14, "wavelength_m": 160}}}},
"placements": [{}, {}],
"camera_path": {},
{}}}
)",
        scene_name(size), plant("pine", 3, 13), plant("stand_tree", 3, 12), plant("shrub", 2, 1.8),
        size.side_m, size.side_m, size.side_m, scatter(R"({"pine": 2, "beech": 1})", 0.03, 3.5, 1),
        scatter(R"({"shrub": 1})", 0.02, 2.0, 2), flight_text({}), light_text());
}

// Its spacing differs along its sides, which a grid's does not: one entry a place.
std::string mosaic_text(size_t index) {
    const Size& size = k_sizes[index];
    std::string places;
    for (uint32_t row = 0; row < size.rows; ++row)
        for (uint32_t column = 0; column < size.columns; ++column)
            places += fmt::format(R"({}{{"scene": "{}.eco.json", "at": [{}, {}]}})",
                                  places.empty() ? "" : ", ", scene_name(k_sizes[index - 1]),
                                  (column - 0.5 * (size.columns - 1)) * size.spacing_x_m,
                                  (row - 0.5 * (size.rows - 1)) * size.spacing_z_m);
    return fmt::format("{{\"name\": \"{}\",\n\"mosaic\": [{}],\n\"camera_path\": {},\n{}}}\n",
                       scene_name(size), places, flight_text(viewed_place(index)), light_text());
}

struct Flight {
    const Size* size;
    std::unique_ptr<PlayHost> host;
    std::vector<double> wall_ms, cpu_ms, vertices, tiles_touched, plants_visible;
    uint64_t triangles = 0, plants = 0, bytes_read = 0, resident_bytes = 0, gpu_bytes = 0;
    uint32_t missing_frames = 0;
    std::string device;
};

Result<std::string> make_scene(const BenchSettings& settings, size_t index, const std::string& folder) {
    const Size& size = k_sizes[index];
    std::error_code error;
    const std::string content = fs::absolute(settings.content, error).lexically_normal().generic_string();
    const std::string file = fmt::format("{}/{}.eco.json", folder, scene_name(size));
    COPPICE_CHECK(write_text_file(file, size.side_m ? wood_text(size, content) : mosaic_text(index)));
    PopulateSettings populated;
    populated.scene = file;
    populated.folder = fmt::format("{}/{}", folder, scene_name(size));
    populated.cache_dir = settings.cache_dir;
    COPPICE_CHECK(populate(populated));
    return populated.folder;
}

PlayOptions options_of(const BenchSettings& settings, const std::string& scene) {
    PlayOptions options;
    options.scene = scene;
    options.headless = true;
    options.width = 795;
    options.height = 700;
    options.device = settings.device;
    options.cache_dir = settings.cache_dir;
    options.pictures = std::string("0");
    options.frames = k_frames;
    options.fps = double(k_frames - 1) / 6.0;
    options.tile_memory_mib = k_tile_memory_mib;
    options.settings.vertex_budget = k_vertex_budget;
    options.settings.shadows = ShadowKind::none;  // a budget is of the picture's primitives
    return options;
}

Status fly(Flight& flight, const PlayOptions& options) {
    COPPICE_TRY(const PlayRecord record, play_headless(*flight.host, options));
    flight.device = record.device;
    flight.triangles = record.scene_triangles;
    flight.plants = record.plants;
    for (const FrameRecord& frame : record.frames) {
        const FrameReport& report = frame.report;
        flight.wall_ms.push_back(frame.wall_ms);
        flight.cpu_ms.push_back(frame.schedule_ms);
        flight.vertices.push_back(double(report.vertices));
        flight.tiles_touched.push_back(double(report.tiles_touched));
        flight.plants_visible.push_back(double(report.plants_visible));
        flight.missing_frames += report.tiles_missing > 0;
        flight.bytes_read = report.stream_bytes_read;
        flight.resident_bytes = std::max(flight.resident_bytes, report.stream_resident_bytes);
        flight.gpu_bytes = std::max(flight.gpu_bytes, report.gpu_bytes);
    }
    return {};
}

std::string page(const std::vector<Flight>& flights) {
    LogPlotSeries time{{"time", "#2f6b3f", 0, true}, {}}, cpu{{"cpu", "#b4545c", 1}, {}};
    std::vector<double> all_x, all_y;
    std::string rows;
    for (const Flight& flight : flights) {
        const double x = double(flight.triangles), ms = median(flight.wall_ms),
                     cpu_ms = median(flight.cpu_ms);
        time.points.push_back({x, ms, fmt::format("{}: {:.1f} ms", flight.size->name, ms)});
        cpu.points.push_back({x, cpu_ms, fmt::format("{}: {:.2f} ms on the CPU", flight.size->name, cpu_ms)});
        all_x.push_back(x);
        all_y.insert(all_y.end(), {ms, cpu_ms});
        rows += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.1f}</td><td>{:.2f}</td><td>{}</td><td>{:.0f}</td><td>{:.0f}</"
            "td>"
            "<td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td></tr>\n",
            short_count(x), short_count(double(flight.plants)), ms, cpu_ms,
            short_count(median(flight.vertices)), median(flight.tiles_touched), median(flight.plants_visible),
            double(flight.bytes_read) / 1048576.0, double(flight.resident_bytes) / 1048576.0,
            double(flight.gpu_bytes) / 1048576.0);
    }
    LogPlotSettings plot;
    plot.label = "Time a frame over triangles of the scene";
    plot.x_name = "triangles of the scene";
    plot.x = log_range(all_x);
    plot.y = log_range(all_y);
    return fmt::format(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Coppice: "
        "scale</title><style>{}</style>"
        "<main><h1>One frame cost, whatever the size</h1><p>{} at 795 x 700, {} vertices a frame, {} MiB of "
        "tiles; "
        "medians of {} flights of {} frames in turns. Milliseconds over triangles: green the whole frame, "
        "red the "
        "CPU's part.</p><div class=\"plot\">{}</div><table><tr><th>triangles</th><th>plants</th><th>frame, "
        "ms</th>"
        "<th>CPU, ms</th><th>vertices</th><th>tiles touched</th><th>plants looked at</th><th>read, MiB</th>"
        "<th>tiles in memory, MiB</th><th>device memory, MiB</th></tr>\n{}</table></main></html>\n",
        k_page_style, escape_html(flights.front().device), short_count(double(k_vertex_budget)),
        k_tile_memory_mib, k_rounds, k_frames, log_plot({time, cpu}, plot), rows);
}

}  // namespace

Result<nlohmann::json> bench_scale(const BenchSettings& settings) {
    const std::string folder =
        (settings.cache_dir.empty() ? default_cache_dir() : settings.cache_dir) + "/scale";
    std::vector<Flight> flights;
    std::vector<PlayOptions> options;
    for (size_t i = 0; i < k_sizes.size(); ++i) {
        COPPICE_TRY(const std::string scene, make_scene(settings, i, folder));
        options.push_back(options_of(settings, scene));
        Flight& flight = flights.emplace_back();
        flight.size = &k_sizes[i];
        COPPICE_TRY(flight.host, PlayHost::create(options.back()));
    }
    for (uint32_t round = 0; round < k_rounds; ++round)
        for (size_t i = 0; i < flights.size(); ++i) COPPICE_CHECK(fly(flights[i], options[i]));

    std::vector<Figure> figures;
    for (const Flight& flight : flights) {
        auto add = [&](const char* what, double value, const char* unit) {
            figures.push_back({fmt::format("{} {}", flight.size->name, what), value, unit, {}});
        };
        add("triangles", double(flight.triangles), "");
        add("median", median(flight.wall_ms), "ms");
        add("CPU", median(flight.cpu_ms), "ms");
        add("vertices", median(flight.vertices), "per frame");
        add("tiles touched", median(flight.tiles_touched), "per frame");
        add("plants looked at", median(flight.plants_visible), "per frame");
        add("read", double(flight.bytes_read) / 1048576.0, "MiB");
        add("tiles in memory", double(flight.resident_bytes) / 1048576.0, "MiB");
        add("device memory", double(flight.gpu_bytes) / 1048576.0, "MiB");
        add("frames with tiles missing", flight.missing_frames, "");
    }
    const Flight &small = flights[1], &large = flights.back();
    figures.push_back(
        {"time, 1e12 over 1e8", median(large.wall_ms) / median(small.wall_ms), "times", 1.2, Reach::at_most});
    figures.push_back({"device memory, 1e12 over 1e8", double(large.gpu_bytes) / double(small.gpu_bytes),
                       "times", 1.2, Reach::at_most});
    const std::string out = settings.out.empty() ? "out/scale" : settings.out;
    COPPICE_CHECK(write_text_file(out + "/index.html", page(flights)));
    fmt::print("{}/index.html\n", out);
    nlohmann::json list = nlohmann::json::array();
    for (const Figure& figure : figures) list.push_back(to_json(figure));
    return nlohmann::json{
        {"name", "scale"}, {"device", flights.front().device}, {"figures", std::move(list)}};
}

}  // namespace coppice
