// Any scene, drawn by the vegetation plugin as a host does, at any size; and what is in the picture.
#pragma once
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/plant/surface.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"
#include "runtime/plugin/registry.h"

namespace coppice {

// A haze hides sizes: none.
inline Light clear_day() {
    Light light;
    light.haze_density_per_m = 0.0f;
    return light;
}

struct PictureCounts {
    size_t pixels = 0, covered = 0;
    size_t wrong_depths = 0;          // outside [0, 1], or not numbers
    dvec3 surface_color_linear{0.0};  // mean over what is covered, before light
    dvec3 shown_color{0.0};           // mean over all pixels, as shown, in [0, 1]
    double covered_share() const { return double(covered) / double(pixels); }
};

class DrawnScene {
  public:
    static Result<std::unique_ptr<DrawnScene>> create(uint32_t width, uint32_t height) {
        std::unique_ptr<DrawnScene> drawn(new DrawnScene);
        COPPICE_CHECK(drawn->registry_.load("vegetation"));
        const auto* interface =
            drawn->registry_.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
        gpu::DeviceSettings device;
        device.validation = true;
        COPPICE_TRY(drawn->device_, gpu::Device::create(device));
        COPPICE_TRY(drawn->ring_, gpu::CommandRing::create(*drawn->device_, k_slots));
        VegetationSettings settings;
        settings.device = drawn->device_.get();
        settings.world = &drawn->world_;
        settings.schedule = &drawn->schedule_;
        settings.frame_graph = &drawn->graph_;
        settings.frame_slots = k_slots;
        settings.width = drawn->width_ = width;
        settings.height = drawn->height_ = height;
        COPPICE_TRY(drawn->vegetation_, interface->create(settings));
        return drawn;
    }

    // placements[i].model.model: of plants.
    Status set(std::span<const Placement> placements, const std::vector<Plant>& plants) {
        Scene scene;
        scene.light = clear_day();
        scene.models.resize(plants.size());
        std::vector<Box> bounds;
        for (const Plant& plant : plants) bounds.push_back(plant.bounds_plant);
        make_tiles(placements, scene);
        finish_tiles(scene, bounds);
        return vegetation_->set_scene(scene, plants);
    }
    Status resize(uint32_t width, uint32_t height) {
        COPPICE_CHECK(vegetation_->resize(width, height));
        width_ = width;
        height_ = height;
        return {};
    }

    // A whole frame, waited for. A list that did not fit is drawn again, by when it does.
    Status draw(const Camera& camera, const FrameSettings& settings) {
        do {
            COPPICE_TRY(const gpu::CommandRing::Frame frame, ring_.begin());
            vegetation_->set_slot(frame.slot);
            vegetation_->set_camera(camera);
            vegetation_->set_settings(settings);
            schedule_.run();
            graph_.record(frame.commands, frame.timestamps);
            COPPICE_CHECK(ring_.submit());
            COPPICE_CHECK(ring_.wait(frame.serial));
        } while (vegetation_->report().dropped_entries > 0);
        words.resize(size_t(width_) * height_);
        colors.resize(words.size());
        COPPICE_CHECK(
            gpu::read_now(*device_, vegetation_->visibility(), 0, std::as_writable_bytes(std::span(words))));
        return gpu::read_now(*device_, vegetation_->color(), 0, std::as_writable_bytes(std::span(colors)));
    }

    PictureCounts count() const {
        PictureCounts counts;
        counts.pixels = words.size();
        for (size_t i = 0; i < words.size(); ++i) {
            for (int c = 0; c < 3; ++c) counts.shown_color[c] += double(colors[i] >> (8 * c) & 255u) / 255.0;
            if (words[i] == 0) continue;
            ++counts.covered;
            const float depth = std::bit_cast<float>(uint32_t(words[i] >> 32));
            counts.wrong_depths += !(depth >= 0.0f && depth <= 1.0f);
            counts.surface_color_linear += dvec3(decode_surface(uint32_t(words[i])).color_linear);
        }
        counts.surface_color_linear /= double(std::max<size_t>(counts.covered, 1));
        counts.shown_color /= double(counts.pixels);
        return counts;
    }

    const FrameReport& report() const { return vegetation_->report(); }
    Vegetation& vegetation() { return *vegetation_; }
    const gpu::Device& device() const { return *device_; }
    uint64_t validation_messages() const { return device_->validation_messages(); }
    // Of the last frame; rows from the top.
    std::vector<uint64_t> words;
    std::vector<uint32_t> colors;

  private:
    static constexpr uint32_t k_slots = 2;
    DrawnScene() = default;

    // In the order of what needs what.
    Registry registry_;
    std::unique_ptr<gpu::Device> device_;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;
    std::unique_ptr<Vegetation> vegetation_;
    gpu::CommandRing ring_;
    uint32_t width_ = 0, height_ = 0;
};

}  // namespace coppice
