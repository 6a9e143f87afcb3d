#include "editor/plant/plant_work.h"

#include "runtime/core/log.h"

namespace coppice {

PlantWork::PlantWork(Settings settings) : settings_(std::move(settings)), thread_([this] { run(); }) {}

PlantWork::~PlantWork() {
    {
        std::lock_guard lock(mutex_);
        quit_ = true;
        ++job_;
    }
    wake_.notify_one();
    thread_.join();
}

void PlantWork::start(PlantSource source) {
    {
        std::lock_guard lock(mutex_);
        source_ = std::move(source);
        plant_.reset();
        figures_.clear();
        cooking_ = true;
        ++job_;
    }
    wake_.notify_one();
}

bool PlantWork::is_cooking() const {
    std::lock_guard lock(mutex_);
    return cooking_;
}
bool PlantWork::is_measuring() const {
    std::lock_guard lock(mutex_);
    return measuring_;
}
std::optional<Result<Plant>> PlantWork::take_plant() {
    std::lock_guard lock(mutex_);
    return std::exchange(plant_, std::nullopt);
}
std::vector<LevelFigures> PlantWork::figures() const {
    std::lock_guard lock(mutex_);
    return figures_;
}
bool PlantWork::is_stale(uint64_t job) const {
    std::lock_guard lock(mutex_);
    return job != job_;
}

void PlantWork::run() {
    uint64_t done = 0;
    while (true) {
        PlantSource source;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return quit_ || job_ != done; });
            if (quit_) return;
            done = job_;
            source = source_;
        }
        Result<std::vector<Plant>> cooked = find_or_cook(settings_.cache_dir, std::span(&source, 1), CookSettings{},
                                                         settings_.modeller, settings_.images);
        const bool whole = cooked.has_value();
        {
            std::lock_guard lock(mutex_);
            if (job_ != done) continue;
            cooking_ = false;
            measuring_ = whole;
            plant_ = whole ? Result<Plant>(cooked->front()) : Result<Plant>(fail(cooked.error()));
        }
        if (whole) measure(cooked->front(), done);
        std::lock_guard lock(mutex_);
        if (job_ == done) measuring_ = false;
    }
}

void PlantWork::measure(const Plant& plant, uint64_t job) {
    if (!device_) {
        gpu::DeviceSettings settings;
        settings.choice = settings_.device;
        auto made = gpu::Device::create(settings);
        if (!made) return log_warning("{}; levels of detail are not measured", to_string(made.error()));
        device_ = std::move(*made);
    }
    auto picture = PlantPicture::create(*device_, plant, k_side_px);
    if (!picture) return log_warning("{}", to_string(picture.error()));
    const vec3 size_m = plant.bounds_plant.size();
    const float side_px = float(k_side_px) - 4.0f;
    for (float height_px : k_sizes_px) {
        // Looked at from any side it has to fit.
        if (height_px * glm::length(size_m) > side_px * size_m.y || is_stale(job)) return;
        auto figures = measure_levels(**picture, height_px, FrameSettings{});
        if (!figures) return log_warning("{}", to_string(figures.error()));
        std::lock_guard lock(mutex_);
        if (job != job_) return;
        figures_.push_back(*figures);
    }
}

}  // namespace coppice
