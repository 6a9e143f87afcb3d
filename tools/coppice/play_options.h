// What the user asked of `coppice play`.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include "plugins/vegetation/lod/settings.h"
#include "runtime/core/math.h"
#include "runtime/core/result.h"
#include "tools/coppice/golden_pictures.h"
#include "tools/coppice/play_check.h"

namespace coppice {

struct PlayOptions {
    std::string scene;  // or a plant, which gets a scene made for it
    std::string path;   // camera path; empty: the scene's own
    bool headless = false;
    uint32_t width = 1280, height = 720;
    std::string out;                          // folder; empty: no files
    uint32_t frames = 0;                      // 0: the whole path
    double fps = 30.0;                        // fixed step: the same frames on every machine
    uint32_t warmup = 5;                      // frames drawn before the first measured one of each repeat
    uint32_t repeats = 1;                     // flights of the path
    std::string pictures = "4";               // see chosen_frames()
    std::optional<float> sample_distance_px;  // empty: what the scene recommends
    std::optional<vec2> sun_deg;              // azimuth and elevation; empty: the scene's own sun
    FrameSettings settings;
    bool compare_full = false;
    uint32_t compare_frames = 5;
    std::vector<Budget> budgets;
    GoldenSettings golden;
    std::string record;  // of a window: file for the path that was flown; empty: none
    std::string device;
    bool validation = false;
    std::string cache_dir;  // of packed plants; empty: the user's cache folder
    uint32_t tile_memory_mib = 256;  // of a populated scene: of tiles in memory, and as much on the device
    bool keep_scene = false;  // PlayHost keeps the whole scene and its plants beside what it draws
};

// "1280x720". Errors: usage.
Status parse_size(const char* option, const std::string& text, uint32_t& width, uint32_t& height);

// "135,20": azimuth and elevation in degrees, within [-360, 360] and [-90, 90]. Errors: usage.
Result<vec2> parse_sun(const std::string& text);

// "0,30,60": these frames; "4": so many, evenly spread, the first and the last among them; "0": none.
// Sorted, without doubles, all below frame_count (others are left out). Errors: usage.
Result<std::vector<uint32_t>> chosen_frames(const std::string& text, uint32_t frame_count);

// `count` of the frames, evenly spread; the first and the last among them where count > 1.
std::vector<uint32_t> spread_frames(uint32_t count, uint32_t frame_count);

}  // namespace coppice
