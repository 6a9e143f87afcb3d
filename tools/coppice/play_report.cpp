#include "tools/coppice/play_report.h"

#include <fmt/format.h>
#include <numeric>
#include "runtime/core/hash.h"
#include "tools/coppice/frame_pace.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

template <class Value>
std::vector<double> over_frames(const PlayRecord& record, Value value) {
    std::vector<double> values;
    values.reserve(record.frames.size());
    for (const FrameRecord& frame : record.frames) values.push_back(double(value(frame)));
    return values;
}

template <class Value>
std::vector<double> over_compared(const PlayRecord& record, Value value) {
    std::vector<double> values;
    for (const ComparedFrame& frame : record.compared) values.push_back(double(value(frame)));
    return values;
}

}  // namespace

const char* name_of(ProjectionMode mode) {
    switch (mode) {
        case ProjectionMode::printed:
            return "printed";
        case ProjectionMode::isotropic:
            return "isotropic";
        case ProjectionMode::measured:
            return "measured";
    }
    return "unknown";
}

std::vector<Figure> play_figures(const PlayRecord& record) {
    const std::vector<double> wall = over_frames(record, [](auto& f) { return f.wall_ms; });
    const double median_ms = median(wall);
    auto count = [&](auto value) { return median(over_frames(record, value)); };
    const FramePace pace = measure_pace(wall);
    double most_dropped = 0.0;
    for (const FrameRecord& frame : record.frames)
        most_dropped = std::max(most_dropped, double(frame.report.dropped_entries));

    std::vector<Figure> figures{
        {"median_ms", median_ms, "ms", {}},
        {"p95_ms", pace.p95_ms, "ms", {}},
        {"p99_ms", pace.p99_ms, "ms", {}},
        {"slowest_ms", quantile(wall, 1.0), "ms", {}},
        {"median_hz", median_ms > 0.0 ? 1000.0 / median_ms : 0.0, "Hz", {}},
        {"low_1_percent_as_p99_hz", pace.low_1_percent_as_p99_hz, "Hz", {}},
        {"low_1_percent_as_mean_hz", pace.low_1_percent_as_mean_hz, "Hz", {}},
        {"hitches", double(pace.hitches), "frames", {}},
        {"cpu_ms", count([](auto& f) { return f.cpu_ms; }), "ms", {}},
        {"gpu_ms", count([](auto& f) { return device_ms(f); }), "ms", {}},
        {"other_programs_share", record.others_share, "", {}},
        {"allocations", count([](auto& f) { return f.allocations; }), "per frame", {}},
        {"cull_ms", count([](auto& f) { return f.report.cull_ms; }), "ms", {}},
        {"lod_ms", count([](auto& f) { return f.report.lod_ms; }), "ms", {}},
        {"write_ms", count([](auto& f) { return f.report.write_ms; }), "ms", {}},
        {"sample_distance_px", count([](auto& f) { return f.report.sample_distance_px; }), "px", {}},
        {"splat_factor", record.settings.splat_factor, "", {}},
        {"vertices", count([](auto& f) { return f.report.vertices; }), "per frame", {}},
        {"triangles", count([](auto& f) { return f.report.triangles; }), "per frame", {}},
        {"lines", count([](auto& f) { return f.report.lines; }), "per frame", {}},
        {"points", count([](auto& f) { return f.report.points; }), "per frame", {}},
        {"leaves", count([](auto& f) { return f.report.leaves; }), "per frame", {}},
        {"terrain_triangles", count([](auto& f) { return f.report.terrain_triangles; }), "per frame", {}},
        {"shadow_map_side", count([](auto& f) { return f.report.shadow_side_texels; }), "texels", {}},
        {"shadow_maps_a_frame",
         record.frames.empty() ? 0.0
                               : std::accumulate(record.frames.begin(), record.frames.end(), 0.0,
                                                 [](double sum, const FrameRecord& frame) {
                                                     return sum + frame.report.shadow_maps;
                                                 }) /
                                     double(record.frames.size()),
         "mean",
         {}},
        {"shadow_plants", count([](auto& f) { return f.report.shadow_plants; }), "per frame", {}},
        {"shadow_triangles", count([](auto& f) { return f.report.shadow_triangles; }), "per frame", {}},
        {"shadow_points", count([](auto& f) { return f.report.shadow_points; }), "per frame", {}},
        {"full_triangles_in_view", count([](auto& f) { return f.report.full_triangles; }), "per frame", {}},
        {"scene_triangles", double(record.scene_triangles), "", {}},
        {"plants", double(record.plants), "", {}},
        {"dropped_entries", most_dropped, "worst frame", {}},
        {"device_memory_mib",
         quantile(over_frames(record, [](auto& f) { return double(f.report.gpu_bytes) / (1 << 20); }), 1.0),
         "MiB",
         {}},
        {"tiles_missing_frames",
         double(std::count_if(record.frames.begin(), record.frames.end(),
                              [](const FrameRecord& f) { return f.report.tiles_missing > 0; })),
         "frames",
         {}},
        {"stream_read_mib", double(record.frames.back().report.stream_bytes_read) / (1 << 20), "MiB", {}},
        {"stream_resident_mib",
         quantile(
             over_frames(record, [](auto& f) { return double(f.report.stream_resident_bytes) / (1 << 20); }),
             1.0),
         "MiB",
         {}},
        {"peak_memory_mib", double(record.peak_memory_bytes) / (1 << 20), "MiB", {}},
        {"load_ms", load_ms(record.load), "ms", {}},
        {"plants_ms", record.load.plants_ms, "ms", {}},
        {"first_frame_ms", record.load.first_frame_ms, "ms", {}},
    };
    for (size_t pass = 0; pass < record.passes.size(); ++pass)
        figures.push_back({"pass_" + record.passes[pass] + "_ms",
                           count([pass](auto& f) { return f.pass_ms.size() > pass ? f.pass_ms[pass] : 0.0; }),
                           "ms",
                           {}});
    if (!record.compared.empty()) {
        double lod = median(over_compared(record, [](auto& f) { return f.lod_ms; }));
        double full = median(over_compared(record, [](auto& f) { return f.full_ms; }));
        figures.push_back({"compared_lod_median_ms", lod, "ms", {}});
        figures.push_back({"compared_full_median_ms", full, "ms", {}});
        figures.push_back({"full_over_lod", lod > 0.0 ? full / lod : 0.0, "times", {}});
        // Of the worst frame: one that shows nothing but sky agrees perfectly and says nothing.
        std::vector<double> psnr_db = over_compared(record, [](auto& f) { return f.psnr_db; });
        figures.push_back(
            {"flip_to_full", quantile(over_compared(record, [](auto& f) { return f.flip; }), 1.0), "", {}});
        figures.push_back({"psnr_to_full_db", *std::min_element(psnr_db.begin(), psnr_db.end()), "dB", {}});
    }
    for (const Check& check : record.checks) {
        if (check.name == "frame") {
            const OverBudget over = measure_over_budget(wall, check.limit);
            figures.push_back({"over_budget_frames", double(over.frames), "frames", {}});
            figures.push_back({"over_budget_ms", over.ms, "ms", {}});
        }
    }
    if (record.validation)
        figures.push_back(
            {"validation_messages", double(record.validation_messages), "", 0.0, Reach::at_most});
    return figures;
}

std::string frames_csv(const PlayRecord& record) {
    std::string csv =
        "frame,repeat,time_s,CPUStartTime,FrameTime,CPUBusy,CPUWait,GPUBusy,schedule_ms,stream_ms,cull_ms,"
        "lod_ms,write_ms";
    for (const std::string& pass : record.passes) csv += ",gpu_" + pass + "_ms";
    csv +=
        ",sample_distance_px,vertex_budget,vertices,triangles,lines,points,leaves,terrain_triangles,full_"
        "triangles,"
        "shadow_map_side,shadow_maps,shadow_plants,shadow_triangles,shadow_lines,shadow_points,shadow_leaves,"
        "tiles_touched,clouds,tiles_missing,stream_bytes_read,stream_resident_bytes,plants_visible,tiles_"
        "hidden,"
        "plants_hidden,work_entries,dropped_entries,device_bytes,allocations\n";
    for (const FrameRecord& frame : record.frames) {
        const FrameReport& report = frame.report;
        csv +=
            fmt::format("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}",
                        frame.frame, frame.repeat, frame.time_s, frame.start_ms, frame.wall_ms, frame.cpu_ms,
                        frame.wall_ms - frame.cpu_ms, device_ms(frame), frame.schedule_ms, report.stream_ms,
                        report.cull_ms, report.lod_ms, report.write_ms);
        for (double ms : frame.pass_ms) csv += fmt::format(",{:.4f}", ms);
        csv += fmt::format(
            ",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
            report.sample_distance_px, report.vertex_budget, report.vertices, report.triangles, report.lines,
            report.points, report.leaves, report.terrain_triangles, report.full_triangles,
            report.shadow_side_texels, report.shadow_maps, report.shadow_plants, report.shadow_triangles,
            report.shadow_lines, report.shadow_points, report.shadow_leaves, report.tiles_touched,
            report.clouds, report.tiles_missing, report.stream_bytes_read, report.stream_resident_bytes,
            report.plants_visible, report.tiles_hidden, report.plants_hidden, report.work_entries,
            report.dropped_entries, report.gpu_bytes, frame.allocations);
    }
    return csv;
}

nlohmann::json play_summary(const PlayRecord& record) {
    using nlohmann::json;
    json figures = json::array(), pictures = json::array(), compared = json::array(), hashes = json::object(),
         checks = json::array();
    for (const Figure& figure : play_figures(record)) figures.push_back(to_json(figure));
    for (const PlayPicture& picture : record.pictures)
        pictures.push_back({{"frame", picture.frame},
                            {"time_s", picture.time_s},
                            {"file", picture.file},
                            {"hash", hash_to_hex(picture.hash)}});
    for (const ComparedFrame& frame : record.compared)
        compared.push_back({{"frame", frame.frame},
                            {"lod_ms", frame.lod_ms},
                            {"full_ms", frame.full_ms},
                            {"lod_vertices", frame.lod_vertices},
                            {"full_triangles", frame.full_triangles},
                            {"psnr_db", frame.psnr_db},
                            {"flip", frame.flip}});
    for (const auto& [name, hash] : record.hashes) hashes[name] = hash_to_hex(hash);
    for (const Check& check : record.checks)
        checks.push_back({{"name", check.name},
                          {"verdict", name_of(check.verdict)},
                          {"value", check.value},
                          {"limit", check.limit},
                          {"unit", check.unit},
                          {"fault", check.fault}});
    const Machine& machine = record.machine;
    return {
        {"command", record.command},
        {"scene", {{"name", record.scene_name}, {"file", record.scene_path}}},
        {"settings",
         {{"width", record.width},
          {"height", record.height},
          {"fps", record.fps},
          {"frames", record.frames.size() / record.repeats},
          {"repeats", record.repeats},
          {"sample_distance_px", record.settings.sample_distance_px},
          {"vertex_budget", record.settings.vertex_budget},
          {"time_budget_ms", record.settings.time_budget_ms},
          {"most_sample_distance_px", record.settings.most_sample_distance_px},
          {"splat_factor", record.settings.splat_factor},
          {"projection", name_of(record.settings.projection)},
          {"level_of_detail", record.settings.level_of_detail},
          {"view", record.settings.view == RepresentationView::lit ? "lit" : "kinds"}}},
        {"machine",
         {{"system", machine.system},
          {"processor", machine.processor},
          {"threads", machine.threads},
          {"memory_gib", machine.memory_gib},
          {"compiler", machine.compiler},
          {"build", machine.build},
          {"device", record.device},
          {"driver", record.driver}}},
        {"load_ms",
         {{"scene", record.load.scene_ms},
          {"device", record.load.device_ms},
          {"plants", record.load.plants_ms},
          {"tiles", record.load.tiles_ms},
          {"upload", record.load.upload_ms},
          {"first_frame", record.load.first_frame_ms}}},
        {"checks", std::move(checks)},
        {"figures", std::move(figures)},
        {"pictures", std::move(pictures)},
        {"compared", std::move(compared)},
        {"hashes", std::move(hashes)},
    };
}

}  // namespace coppice
