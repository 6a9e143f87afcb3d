#include "tools/coppice/play_loop.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <fmt/format.h>
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/log.h"
#include "runtime/core/progress.h"
#include "tools/accuracy/flip.h"
#include "tools/accuracy/metrics.h"
#include "tools/coppice/allocation_count.h"
#include "tools/coppice/golden_pictures.h"
#include "tools/coppice/machine_load.h"
#include "tools/coppice/play_junit.h"
#include "tools/coppice/play_page.h"
#include "tools/coppice/play_report.h"
#include "tools/coppice/play_trace.h"

namespace coppice {
namespace {

constexpr uint32_t k_frames_of_a_still_camera = 60;
constexpr uint32_t k_frame_limit = 1'000'000;
constexpr uint32_t k_growth_tries = 6;  // the work list at least doubles each time

// Peak signal to noise of the colours, in dB; 99 where they are equal. Requires the same size.
double psnr_db(const Picture& picture, const Picture& reference) {
    double sum = 0.0;
    for (size_t i = 0; i < picture.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        double difference = double(picture.rgba[i]) - double(reference.rgba[i]);
        sum += difference * difference;
    }
    double mean = sum / (double(picture.rgba.size()) * 0.75);
    return mean > 0.0 ? std::min(99.0, 10.0 * std::log10(255.0 * 255.0 / mean)) : 99.0;
}

Result<double> mean_flip(const Picture& picture, const Picture& reference) {
    COPPICE_TRY(const std::vector<float> map, flip_map(decode_srgb(picture), decode_srgb(reference)));
    return std::accumulate(map.begin(), map.end(), 0.0) / double(map.size());
}

// images may be null: PPM then.
Result<PlayPicture> keep_picture(const ImagesInterface* images, const PlayOptions& options, uint32_t frame,
                                 const Picture& picture) {
    PlayPicture kept{frame,
                     double(frame) / options.fps,
                     fmt::format("frame_{:04}.{}", frame, images ? "png" : "ppm"),
                     {},
                     hash_bytes(picture.rgba.data(), picture.rgba.size())};
    const std::string path = options.out + "/" + kept.file;
    if (images) {
        COPPICE_TRY(kept.png, images->encode_png(picture));
    }
    if (!options.out.empty()) COPPICE_CHECK(images ? write_file(path, kept.png) : write_ppm(path, picture));
    return kept;
}

// Writes the device times of each slot's frame into that frame's record, as long as it lives.
class PassTimes {
  public:
    PassTimes(PlayHost& host, PlayRecord& record) : host_(host), record_(record) {
        host_.read_times = [this](uint32_t slot, auto sections) { read(slot, sections); };
    }
    ~PassTimes() { host_.read_times = nullptr; }
    PassTimes(const PassTimes&) = delete;
    PassTimes& operator=(const PassTimes&) = delete;
    void expect(uint32_t slot, size_t frame) {
        if (slot >= frames_.size()) frames_.resize(slot + 1, k_none);
        frames_[slot] = frame;
    }

  private:
    void read(uint32_t slot, std::span<const gpu::Timestamps::Section> sections) {
        if (slot >= frames_.size() || frames_[slot] == k_none) return;
        FrameRecord& frame = record_.frames[frames_[slot]];
        frames_[slot] = k_none;
        size_t next = 0;  // where a pass that was never seen before belongs: behind the one before it
        for (const auto& section : sections) {
            auto pass = std::find(record_.passes.begin(), record_.passes.end(), section.name);
            const size_t index = pass == record_.passes.end() ? next : size_t(pass - record_.passes.begin());
            if (pass == record_.passes.end()) insert_pass(index, section.name);
            if (frame.pass_ms.size() <= index) frame.pass_ms.resize(index + 1, 0.0);
            frame.pass_ms[index] += section.ms;
            next = index + 1;
        }
    }
    void insert_pass(size_t index, const char* name) {
        record_.passes.insert(record_.passes.begin() + ptrdiff_t(index), name);
        for (FrameRecord& frame : record_.frames)
            if (frame.pass_ms.size() > index)
                frame.pass_ms.insert(frame.pass_ms.begin() + ptrdiff_t(index), 0.0);
    }

    static constexpr size_t k_none = SIZE_MAX;
    PlayHost& host_;
    PlayRecord& record_;
    std::vector<size_t> frames_;
};

// The frame with level of detail has just been drawn in lod_ms.
Result<ComparedFrame> compare_with_full(PlayHost& host, const Camera& camera, const FrameSettings& settings,
                                        uint32_t frame, double lod_ms, const Picture& lod_picture) {
    ComparedFrame compared{frame, lod_ms, 0.0, host.vegetation->report().vertices, 0, 0.0};
    FrameSettings full = settings;
    full.level_of_detail = false;
    for (uint32_t tries = 0;;
         ++tries) {  // the first draws may find the work list too short, and make it grow
        COPPICE_TRY(PlayHost::FrameTimes times, host.draw_frame(camera, full));
        compared.full_ms = times.wall_ms;
        const uint64_t dropped = host.vegetation->report().dropped_entries;
        if (dropped == 0 && tries > 0) break;
        if (tries == k_growth_tries)
            return fail(ErrorId::limit_exceeded, "", "frame " + std::to_string(frame),
                        fmt::format("{} entries of the work list of all triangles do not fit", dropped),
                        "a smaller scene, or no --compare-full");
    }
    compared.full_triangles = host.vegetation->report().triangles;
    COPPICE_TRY(Picture full_picture, host.read_picture());
    compared.psnr_db = psnr_db(lod_picture, full_picture);
    COPPICE_TRY(compared.flip, mean_flip(lod_picture, full_picture));
    COPPICE_CHECK(host.draw_frame(camera, settings));  // what follows finds its data as it would have
    return compared;
}

PlayRecord describe(const PlayHost& host, const PlayOptions& options) {
    PlayRecord record;
    record.command = command_line();
    record.scene_name = host.scene.name;
    record.scene_path = host.scene.path;
    record.width = host.width;
    record.height = host.height;
    record.fps = options.fps;
    record.repeats = options.repeats;
    record.settings = options.settings;
    record.settings.sample_distance_px = options.sample_distance_px.value_or(host.scene.sample_distance_px);
    record.machine = describe_machine();
    record.device = host.device->name;
    record.driver = host.device->driver;
    record.validation = options.validation;
    record.plants = host.plant_count;
    record.hashes = host.hashes;
    return record;
}

}  // namespace

uint32_t count_frames(const PlayOptions& options, const Scene& scene) {
    if (options.frames > 0) return std::min(options.frames, k_frame_limit);
    const double duration_s = scene.camera_path.back().time_s;
    if (!(duration_s > 0.0)) return k_frames_of_a_still_camera;
    return uint32_t(std::min(std::floor(duration_s * options.fps) + 1.0, double(k_frame_limit)));
}

Result<PlayRecord> play_headless(PlayHost& host, const PlayOptions& options) {
    PlayRecord record = describe(host, options);
    const FrameSettings settings = record.settings;
    const uint32_t frame_count = count_frames(options, host.scene);
    COPPICE_TRY(const std::vector<uint32_t> picture_frames, chosen_frames(options.pictures, frame_count));
    const std::vector<uint32_t> compared_frames =
        options.compare_full ? spread_frames(options.compare_frames, frame_count) : std::vector<uint32_t>();
    auto is_in = [](const std::vector<uint32_t>& frames, uint32_t frame) {
        return std::binary_search(frames.begin(), frames.end(), frame);
    };

    const ImagesInterface* images = nullptr;
    if (!picture_frames.empty() && !(images = host.find_images()))
        log_note("the images plugin is not installed: pictures are written as PPM");

    PassTimes pass_times(host, record);
    Progress progress("flying", uint64_t(frame_count) * options.repeats);
    record.frames.reserve(size_t(frame_count) * options.repeats);
    std::optional<MachineLoad> machine_load;
    Stopwatch since_start;
    for (uint32_t repeat = 0; repeat < options.repeats; ++repeat) {
        for (uint32_t i = 0; i < options.warmup; ++i) {
            COPPICE_TRY(PlayHost::FrameTimes times,
                        host.draw_frame(camera_at(host.scene.camera_path, 0.0), settings));
            if (i == 0 && repeat == 0) host.load.first_frame_ms = times.wall_ms;
        }
        if (repeat == 0) {
            machine_load.emplace();
            since_start = {};
        }
        for (uint32_t i = 0; i < frame_count; ++i) {
            const double time_s = double(i) / options.fps, start_ms = since_start.ms();
            const Camera camera = camera_at(host.scene.camera_path, time_s);
            const uint64_t allocations = allocation_count();
            COPPICE_TRY(PlayHost::FrameTimes times, host.draw_frame(camera, settings));
            pass_times.expect(times.slot, record.frames.size());
            record.frames.push_back({i, time_s, times.wall_ms, times.schedule_ms, {}, host.vegetation->report(), repeat,
                                     start_ms, times.cpu_ms, allocation_count() - allocations});
            progress.advance();
            const bool kept = is_in(picture_frames, i), compared = is_in(compared_frames, i);
            if (repeat > 0 || (!kept && !compared)) continue;
            COPPICE_TRY(Picture picture, host.read_picture());
            if (kept) {
                COPPICE_TRY(PlayPicture one, keep_picture(images, options, i, picture));
                if (!options.golden.folder.empty())
                    COPPICE_CHECK(check_golden(options.golden, images, picture, one, options.out, record));
                record.pictures.push_back(std::move(one));
            }
            if (compared) {
                COPPICE_TRY(ComparedFrame one,
                            compare_with_full(host, camera, settings, i, times.wall_ms, picture));
                record.compared.push_back(one);
            }
        }
    }
    record.load = host.load;
    record.others_share = machine_load ? machine_load->others_share() : 0.0;
    COPPICE_CHECK(host.finish_times());
    for (FrameRecord& frame : record.frames) frame.pass_ms.resize(record.passes.size(), 0.0);
    record.scene_triangles = record.frames.back().report.scene_triangles;
    record.validation_messages = host.device->validation_messages();
    record.streamed = host.vegetation->report().stream_bytes_read > 0;
    // Of a populated scene the world holds what happened to be near.
    if (!record.streamed) record.hashes.emplace_back("world", host.world.hash());
    record.peak_memory_bytes = peak_memory_bytes();
    const std::vector<Check> checks = check_playthrough(record, options.budgets);
    record.checks.insert(record.checks.begin(), checks.begin(), checks.end());
    return record;
}

Status write_report(const PlayRecord& record, const std::string& out) {
    COPPICE_CHECK(write_text_file(out + "/frames.csv", frames_csv(record)));
    const auto replace = nlohmann::json::error_handler_t::replace;
    COPPICE_CHECK(
        write_text_file(out + "/summary.json", play_summary(record).dump(2, ' ', false, replace) + "\n"));
    COPPICE_CHECK(write_text_file(out + "/trace.json", chrome_trace(record)));
    COPPICE_CHECK(write_text_file(out + "/junit.xml", junit_xml(record)));
    return write_text_file(out + "/index.html", play_page(record));
}

}  // namespace coppice
