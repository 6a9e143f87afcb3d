#include "tools/coppice/play_page.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <fmt/format.h>
#include "runtime/core/hash.h"
#include "tools/coppice/frame_pace.h"
#include "tools/coppice/page_style.h"
#include "tools/coppice/page_text.h"
#include "tools/coppice/play_options.h"
#include "tools/coppice/play_plot.h"
#include "tools/coppice/play_report.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

// Enough apart to be told from one another side by side, dark to light.
constexpr const char* k_colors[] = {"#28506b", "#3f8f5b", "#8cbf6a", "#e0b64c", "#d98148", "#b4545c",
                                    "#7d5a8c", "#5b86b8", "#4fa3a0", "#a3a86b", "#c79ab0", "#8a8f8c"};

constexpr uint32_t k_picture_limit = 24;

const PlayPicture& middle_picture(const PlayRecord& record) {
    return record.pictures[record.pictures.size() / 2];
}

std::string encode_base64(std::span<const std::byte> bytes) {
    static constexpr char k_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t count = std::min<size_t>(3, bytes.size() - i);
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? uint32_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += k <= count ? k_digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string card(const std::string& value, const std::string& meaning) {
    return fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", value, meaning);
}

std::string figure(const PlayPicture& picture, const char* css_class) {
    const std::string source = picture.png.empty() ? escape_html(picture.file)
                                                   : "data:image/png;base64," + encode_base64(picture.png);
    return fmt::format(
        "<figure class=\"{}\"><img src=\"{}\" alt=\"Frame {}\"><figcaption>frame {}, {:.2f} s"
        "</figcaption></figure>\n",
        css_class, source, picture.frame, picture.frame, picture.time_s);
}

std::string cards(const PlayRecord& record) {
    std::vector<double> wall, vertices, full;
    for (const FrameRecord& frame : record.frames) {
        wall.push_back(frame.wall_ms);
        vertices.push_back(double(frame.report.vertices));
        full.push_back(double(frame.report.full_triangles));
    }
    const double median_ms = std::max(median(wall), 1e-6);
    std::string html = "<div class=\"cards\">\n";
    html += card(fmt::format("{:.1f} ms", median_ms),
                 fmt::format("a frame, median: {:.0f} frames a second", 1000.0 / median_ms));
    html += card(fmt::format("{:.1f} ms", quantile(wall, 0.95)), "or less for 95 % of the frames");
    const FramePace pace = measure_pace(wall);
    html += card(
        fmt::format("{:.1f} Hz", pace.low_1_percent_as_p99_hz),
        fmt::format("1 % low as the p99 frame time; {:.1f} Hz as the mean of the slowest 1 %; {} hitches",
                    pace.low_1_percent_as_mean_hz, pace.hitches));
    html += card(short_count(median(vertices)),
                 fmt::format("vertices drawn a frame, for {} triangles in view", short_count(median(full))));
    html += card(short_count(double(record.scene_triangles)),
                 fmt::format("triangles in the scene, {} plants", short_count(double(record.plants))));
    if (!record.compared.empty()) {
        std::vector<double> lod_ms, full_ms;
        for (const ComparedFrame& frame : record.compared) {
            lod_ms.push_back(frame.lod_ms);
            full_ms.push_back(frame.full_ms);
        }
        html += card(fmt::format("{:.3g} times", median(full_ms) / std::max(median(lod_ms), 1e-6)),
                     "less time than drawing every triangle");
    }
    return html + "</div>\n";
}

// What a frame's wall time consists of: the systems on the CPU, the passes on the device, the rest.
std::string time_plot(const PlayRecord& record, const std::vector<double>& time_s) {
    std::vector<PlotSeries> series;
    auto add = [&](std::string name, auto value) {
        PlotSeries one{std::move(name), k_colors[series.size() % std::size(k_colors)], {}};
        for (const FrameRecord& frame : record.frames) one.values.push_back(std::max(value(frame), 0.0));
        series.push_back(std::move(one));
    };
    add("cull (CPU)", [](auto& f) { return f.report.cull_ms; });
    add("level of detail (CPU)", [](auto& f) { return f.report.lod_ms; });
    add("work list (CPU)", [](auto& f) { return f.report.write_ms; });
    for (size_t pass = 0; pass < record.passes.size(); ++pass)
        add(record.passes[pass], [pass](auto& f) { return pass < f.pass_ms.size() ? f.pass_ms[pass] : 0.0; });
    add("everything else", [](auto& f) {
        double known = f.report.cull_ms + f.report.lod_ms + f.report.write_ms;
        for (double ms : f.pass_ms) known += ms;
        return f.wall_ms - known;
    });
    series.back().color = "#d5dad4";
    return stacked_plot(time_s, series, {"Frame time by pass", "flight time, s", "ms a frame"});
}

std::string count_plot(const PlayRecord& record, const std::vector<double>& time_s) {
    std::vector<PlotSeries> series{{"points", "#c8553d", {}},
                                   {"lines, two vertices each", "#3d6fa8", {}},
                                   {"triangles, three vertices each", "#4f9a5a", {}},
                                   {"leaves, four vertices each", "#d3b13a", {}}};
    for (const FrameRecord& frame : record.frames) {
        series[0].values.push_back(double(frame.report.points));
        series[1].values.push_back(2.0 * double(frame.report.lines));
        series[2].values.push_back(3.0 * double(frame.report.triangles));
        series[3].values.push_back(4.0 * double(frame.report.leaves));
    }
    return stacked_plot(time_s, series, {"Vertices drawn by kind", "flight time, s", "vertices a frame"});
}

std::string compared_table(const PlayRecord& record) {
    if (record.compared.empty()) return {};
    std::string html =
        "<h2>Against every triangle</h2>\n<p class=\"soft\">The same frames in the same run, once with level "
        "of "
        "detail and once with every triangle in view, one after the other. The last column is how much alike "
        "the two "
        "pictures are (peak signal to noise; more is better).</p>\n<table "
        "class=\"numbers\"><tr><th>frame</th>"
        "<th>level of detail, ms</th><th>every triangle, "
        "ms</th><th>ratio</th><th>vertices</th><th>triangles</th>"
        "<th>dB</th></tr>\n";
    for (const ComparedFrame& frame : record.compared)
        html += fmt::format(
            "<tr><td>{}</td><td>{:.2f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{}</td><td>{}</td>"
            "<td>{:.1f}</td></tr>\n",
            frame.frame, frame.lod_ms, frame.full_ms, frame.full_ms / std::max(frame.lod_ms, 1e-6),
            short_count(double(frame.lod_vertices)), short_count(double(frame.full_triangles)),
            frame.psnr_db);
    return html + "</table>\n";
}

std::string checks_table(const PlayRecord& record) {
    if (record.checks.empty()) return {};
    std::string html =
        "<h2>Checks</h2>\n<table><tr><th>check</th><th>verdict</th><th>found</th><th>limit</th></tr>\n";
    for (const Check& check : record.checks)
        html += fmt::format("<tr><td>{}</td><td>{}{}</td><td>{:.6g} {}</td><td>{:g}</td></tr>\n",
                            escape_html(check.name), name_of(check.verdict),
                            check.fault.empty() ? "" : ": " + escape_html(check.fault), check.value,
                            escape_html(check.unit), check.limit);
    html += "</table>\n";
    if (record.differences.empty()) return html;
    html +=
        "<p class=\"soft\">Where pictures differ from their goldens: FLIP of each pixel, white is most.</p>\n"
        "<div class=\"pictures\">\n";
    for (const PlayPicture& difference : record.differences) html += figure(difference, "");
    return html + "</div>\n";
}

// Where frames lie in the plots: one repeat behind the other.
double plotted_time_s(const PlayRecord& record, const FrameRecord& frame) {
    const double repeat_s = double(record.frames.size()) / record.repeats / std::max(record.fps, 1e-9);
    return frame.time_s + frame.repeat * repeat_s;
}

std::string facts_table(const PlayRecord& record) {
    std::string html = "<table>\n";
    auto row = [&html](const std::string& name, const std::string& value) {
        if (!value.empty())
            html += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape_html(name), escape_html(value));
    };
    const Machine& machine = record.machine;
    row("device", record.device);
    row("driver", record.driver);
    row("processor",
        fmt::format("{}, {} threads, {:.1f} GiB", machine.processor, machine.threads, machine.memory_gib));
    row("system", machine.system);
    row("program", fmt::format("Coppice {}, {}, {}", COPPICE_VERSION, machine.build, machine.compiler));
    row("picture", fmt::format("{} x {}", record.width, record.height));
    row("flight",
        fmt::format("{} frames, {:g} a second of flight{}", record.frames.size() / record.repeats, record.fps,
                    record.repeats > 1 ? fmt::format(", {} times", record.repeats) : ""));
    row("other programs", fmt::format("{:.0f} % of the processors meanwhile", 100.0 * record.others_share));
    row("sample distance d'", fmt::format("{:g} px", record.settings.sample_distance_px));
    row("splat factor c_p", fmt::format("{:g}", record.settings.splat_factor));
    row("projection", name_of(record.settings.projection));
    row("level of detail", record.settings.level_of_detail ? "on" : "off: every triangle");
    const LoadTimes& load = record.load;
    row("loading, ms",
        fmt::format("scene {:.0f}, device {:.0f}, plants {:.0f}, tiles {:.0f}, upload {:.0f}, first "
                    "frame {:.0f}",
                    load.scene_ms, load.device_ms, load.plants_ms, load.tiles_ms, load.upload_ms,
                    load.first_frame_ms));
    if (record.validation) row("validation layers", fmt::format("{} messages", record.validation_messages));
    for (const auto& [name, hash] : record.hashes) row("hash of " + name, hash_to_hex(hash));
    for (const PlayPicture& picture : record.pictures)
        row(fmt::format("hash of picture {}", picture.frame), hash_to_hex(picture.hash));
    return html + "</table>\n";
}

}  // namespace

std::string play_page(const PlayRecord& record) {
    std::vector<double> time_s;
    for (const FrameRecord& frame : record.frames) time_s.push_back(plotted_time_s(record, frame));
    const std::string name = escape_html(record.scene_name);
    std::string html = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><title>{0} - "
        "Coppice</title><style>{1}</style></head>\n"
        "<body><main>\n<h1>{0}</h1>\n<p class=\"soft\">A flight of {2} frames at {3} x {4} pixels, drawn by "
        "Coppice "
        "on {5}. Plants far away are drawn as fewer points and lines, near ones as triangles, so that the "
        "picture "
        "decides what a frame costs.</p>\n",
        name, k_page_style, record.frames.size(), record.width, record.height, escape_html(record.device));
    if (!record.pictures.empty()) html += figure(middle_picture(record), "hero");
    html += cards(record);
    html += checks_table(record);
    html +=
        "<h2>Time of a frame</h2>\n<p class=\"soft\">From the start of a frame until its picture was "
        "complete, "
        "nothing overlapped; by what the time went into.</p>\n<div class=\"plot\">" +
        time_plot(record, time_s) + "</div>\n";
    html +=
        "<h2>What was drawn</h2>\n<p class=\"soft\">Vertices of the plants by kind of primitive.</p>\n"
        "<div class=\"plot\">" +
        count_plot(record, time_s) + "</div>\n";
    html += compared_table(record);
    if (record.pictures.size() > 1) {
        html += "<h2>Pictures</h2>\n<div class=\"pictures\">\n";
        // A page of hundreds of pictures opens nowhere: the others stay files.
        for (uint32_t i : spread_frames(k_picture_limit, uint32_t(record.pictures.size())))
            if (&record.pictures[i] != &middle_picture(record)) html += figure(record.pictures[i], "");
        html += "</div>\n";
    }
    html += "<h2>Machine, settings, hashes</h2>\n" + facts_table(record);
    html += "<h2>Again</h2>\n<p><code>" + escape_html(record.command) +
            "</code></p>\n<p class=\"soft\">Every frame's figures are in frames.csv and summary.json beside "
            "this page, and in trace.json for chrome://tracing or Perfetto."
            "</p>\n</main></body></html>\n";
    return html;
}

}  // namespace coppice
