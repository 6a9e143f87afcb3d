// A plant cooked, and its levels of detail measured, in a thread of their own: neither stops the window.
#pragma once
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/report/measure_levels.h"

namespace coppice {

class PlantWork {
  public:
    struct Settings {
        std::string cache_dir, device;
        const ModellerInterface* modeller = nullptr;
        const ImagesInterface* images = nullptr;
    };
    explicit PlantWork(Settings settings);
    ~PlantWork();  // a cook that is going on is waited for

    // In place of what was asked for before.
    void start(PlantSource source);
    bool is_cooking() const;
    bool is_measuring() const;
    // The plant, or why there is none; once.
    std::optional<Result<Plant>> take_plant();
    // So far, from small sizes to large ones; of the plant that was started last. A device that cannot measure gives none.
    std::vector<LevelFigures> figures() const;

    // Heights in pixels that are measured.
    static constexpr float k_sizes_px[] = {12, 18, 27, 40, 60, 90, 135, 200, 300, 440};
    static constexpr uint32_t k_side_px = 512;  // of the pictures that are

  private:
    void run();
    // Whether something else has been asked for since.
    bool is_stale(uint64_t job) const;
    void measure(const Plant& plant, uint64_t job);

    Settings settings_;
    std::unique_ptr<gpu::Device> device_;  // the thread's own
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool quit_ = false, cooking_ = false, measuring_ = false;
    uint64_t job_ = 0;  // counts what was started
    PlantSource source_;
    std::optional<Result<Plant>> plant_;
    std::vector<LevelFigures> figures_;
    std::thread thread_;  // last: it uses all others
};

}  // namespace coppice
