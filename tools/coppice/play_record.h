// What a playthrough left behind, in memory: the report and the page are made from it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>
#include "plugins/vegetation/lod/settings.h"
#include "plugins/vegetation/report/report.h"
#include "tools/coppice/machine.h"
#include "tools/coppice/play_check.h"

namespace coppice {

struct FrameRecord {
    uint32_t frame;
    double time_s;
    double wall_ms;      // from the start of the frame to its picture being complete, nothing overlapped
    double schedule_ms;  // CPU: the systems, cull and lod among them
    std::vector<double> pass_ms;  // device time, as PlayRecord::passes; a pass that did not run has 0
    FrameReport report;
    uint32_t repeat = 0;
    double start_ms = 0.0;     // since the first measured frame began
    double cpu_ms = 0.0;       // from the start of the frame until it was submitted
    uint64_t allocations = 0;  // calls of operator new, of all threads
};
inline double device_ms(const FrameRecord& frame) {
    return std::accumulate(frame.pass_ms.begin(), frame.pass_ms.end(), 0.0);
}

struct PlayPicture {
    uint32_t frame;
    double time_s;
    std::string file;            // beside the page
    std::vector<std::byte> png;  // empty where the images plugin is not installed
    uint64_t hash;               // of the pixels
};

// The same frames drawn with and without level of detail, one after the other.
struct ComparedFrame {
    uint32_t frame;
    double lod_ms, full_ms;
    uint64_t lod_vertices, full_triangles;
    double psnr_db;     // of the picture with level of detail against the one without
    double flip = 0.0;  // likewise, mean FLIP of the pixels
};

struct LoadTimes {
    double scene_ms, device_ms;
    double plants_ms;  // found in the cache and checked, or cooked
    double tiles_ms;   // their bounds, and the ground's shade
    double upload_ms, first_frame_ms;
};
inline double load_ms(const LoadTimes& load) {
    return load.scene_ms + load.device_ms + load.plants_ms + load.tiles_ms + load.upload_ms;
}

struct PlayRecord {
    std::string command;  // what to type to get this again
    std::string scene_name, scene_path;
    uint32_t width, height;
    double fps;
    FrameSettings settings;
    Machine machine;
    std::string device, driver;
    uint64_t validation_messages = 0;
    bool validation = false;
    uint64_t plants = 0, scene_triangles = 0;
    LoadTimes load{};
    std::vector<std::string> passes;  // in order of execution
    std::vector<FrameRecord> frames;  // of all repeats, one after the other
    uint32_t repeats = 1;
    double others_share = 0.0;  // of the machine's processors that other programs had meanwhile
    uint64_t peak_memory_bytes = 0;
    bool streamed = false;              // a populated scene: tiles were read on the way
    std::vector<PlayPicture> pictures;  // of the first repeat
    std::vector<PlayPicture> differences;  // from goldens, where a picture did not agree: FLIP, white is 1
    std::vector<Check> checks;
    std::vector<ComparedFrame> compared;
    std::vector<std::pair<std::string, uint64_t>> hashes;  // of what was drawn: scene file, plants
};

}  // namespace coppice
