#include "tools/coppice/play_lockstep.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "tools/coppice/allocation_count.h"
#include "tools/coppice/play_loop.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

void write_line(const nlohmann::json& json) {
    fmt::print("{}\n", json.dump());
    std::fflush(stdout);
}

}  // namespace

std::map<std::string, double> frame_counts(const FrameReport& report, uint64_t allocations) {
    return {{"vertices", double(report.vertices)},
            {"triangles", double(report.triangles)},
            {"lines", double(report.lines)},
            {"points", double(report.points)},
            {"leaves", double(report.leaves)},
            {"tiles_touched", double(report.tiles_touched)},
            {"device_bytes", double(report.gpu_bytes)},
            {"allocations", double(allocations)},
            {"work_entries", double(report.work_entries)},
            {"stream_resident_bytes", double(report.stream_resident_bytes)}};
}

Status play_in_lockstep(PlayHost& host, const PlayOptions& options) {
    FrameSettings settings = options.settings;
    settings.sample_distance_px = options.sample_distance_px.value_or(host.scene.sample_distance_px);
    const uint32_t frame_count = count_frames(options, host.scene);
    for (uint32_t i = 0; i < options.warmup; ++i)
        COPPICE_CHECK(host.draw_frame(camera_at(host.scene.camera_path, 0.0), settings));
    write_line({{"frames", frame_count}});
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        uint32_t frame = 0;
        double slower = 0.0;
        if (!(words >> frame >> slower) || frame >= frame_count || !(slower >= 0.0) || slower > 10.0)
            return fail(
                ErrorId::usage, "standard input", "", fmt::format("'{}' asks for no frame", line),
                fmt::format("write FRAME SLOWER, a frame below {} and a share from 0 to 10", frame_count));
        const Camera camera = camera_at(host.scene.camera_path, double(frame) / options.fps);
        const uint64_t allocations = allocation_count();
        Stopwatch clock;
        COPPICE_CHECK(host.draw_frame(camera, settings));
        const uint64_t allocated = allocation_count() - allocations;
        const double until_ms = clock.ms() * (1.0 + slower);
        while (slower > 0.0 && clock.ms() < until_ms) continue;
        const double ms = clock.ms();
        write_line({{"ms", ms}, {"counts", frame_counts(host.vegetation->report(), allocated)}});
    }
    return {};
}

}  // namespace coppice
