// Woods and meadows on hills, drawn by the vegetation plugin as a host does.
#pragma once
#include <gtest/gtest.h>
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/core/random.h"
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"
#include "runtime/plugin/registry.h"
#include "tests/images/cook_species.h"

namespace coppice {

struct HillsSettings {
    float amplitude_m = 22.0f;
    uint32_t birches = 900, shrubs = 2500, grasses = 9000;
    bool validation = false;
};

class Hills {
  public:
    static constexpr uint32_t k_width = 480, k_height = 320, k_slots = 2;
    static constexpr float k_side_m = 640.0f;

    static Result<std::unique_ptr<Hills>> create(const HillsSettings& settings) {
        std::unique_ptr<Hills> hills(new Hills);
        COPPICE_CHECK(hills->make_scene(settings));
        COPPICE_CHECK(hills->registry_.load("vegetation"));
        const auto* interface =
            hills->registry_.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
        gpu::DeviceSettings device_settings;
        device_settings.validation = settings.validation;
        COPPICE_TRY(hills->device_, gpu::Device::create(device_settings));
        COPPICE_TRY(hills->ring_, gpu::CommandRing::create(*hills->device_, k_slots));
        VegetationSettings vegetation;
        vegetation.device = hills->device_.get();
        vegetation.world = &hills->world_;
        vegetation.schedule = &hills->schedule_;
        vegetation.frame_graph = &hills->graph_;
        vegetation.frame_slots = k_slots;
        vegetation.width = k_width;
        vegetation.height = k_height;
        COPPICE_TRY(hills->vegetation, interface->create(vegetation));
        COPPICE_CHECK(hills->vegetation->set_scene(hills->scene_, std::move(hills->plants_)));
        return hills;
    }

    // above_m: over the ground there.
    Camera camera_at(float x, float z, float above_m, float yaw_rad, float pitch_rad = -0.05f) const {
        Camera camera;
        camera.position_world = dvec3(x, double(scene_.terrain->height_at(x, z)) + above_m, z);
        camera.yaw_rad = yaw_rad;
        camera.pitch_rad = pitch_rad;
        return camera;
    }

    // The systems alone: nothing is drawn.
    const FrameReport& plan(const Camera& camera, const FrameSettings& settings) {
        vegetation->set_slot(0);
        vegetation->set_camera(camera);
        vegetation->set_settings(settings);
        schedule_.run();
        return vegetation->report();
    }

    // A whole frame, waited for. A list that did not fit is drawn again, by when it does.
    Status draw(const Camera& camera, const FrameSettings& settings) {
        do {
            COPPICE_TRY(const gpu::CommandRing::Frame frame, ring_.begin());
            vegetation->set_slot(frame.slot);
            vegetation->set_camera(camera);
            vegetation->set_settings(settings);
            const size_t before = count_allocations ? count_allocations() : 0;
            schedule_.run();
            graph_.record(frame.commands, frame.timestamps);
            if (count_allocations) allocations += count_allocations() - before;
            COPPICE_CHECK(ring_.submit());
            COPPICE_CHECK(ring_.wait(frame.serial));
        } while (vegetation->report().dropped_entries > 0);
        return {};
    }
    template <class Word>
    Result<std::vector<Word>> read(const gpu::Buffer& buffer) const {
        std::vector<Word> words(size_t(k_width) * k_height);
        COPPICE_CHECK(gpu::read_now(*device_, buffer, 0, std::as_writable_bytes(std::span(words))));
        return words;
    }
    // Of the frame's CPU side, from the first system to the last pass recorded, where they can be counted.
    size_t (*count_allocations)() = nullptr;
    size_t allocations = 0;
    uint64_t validation_messages() const { return device_->validation_messages(); }

  private:
    Hills() = default;

    Status make_scene(const HillsSettings& settings) {
        const std::string terrain =
            R"({"procedural": {"size_m": )" + std::to_string(k_side_m) +
            R"(, "cell_m": 4, "seed": 3, "wavelength_m": 160, "octaves": 4, "amplitude_m": )" +
            std::to_string(settings.amplitude_m) + "}}";
        COPPICE_TRY(scene_.terrain, load_terrain(terrain, "", "hills"));
        std::vector<Box> bounds;
        for (const char* species : {"birch", "shrub", "grass"}) {
            COPPICE_TRY(Plant plant, cook_species(species));
            bounds.push_back(plant.bounds_plant);
            plants_.push_back(std::move(plant));
        }
        scene_.models.resize(plants_.size());
        std::vector<Placement> placements;
        Random random(7);
        const uint32_t counts[] = {settings.birches, settings.shrubs, settings.grasses};
        for (uint32_t model = 0; model < 3; ++model)
            for (uint32_t i = 0; i < counts[model]; ++i) {
                const float x = random.next_in(-0.48f, 0.48f) * k_side_m;
                const float z = random.next_in(-0.48f, 0.48f) * k_side_m;
                const float scale = random.next_in(0.7f, 1.3f), turn = random.next_in(0.0f, 6.28f);
                placements.push_back({dvec3(x, scene_.terrain->height_at(x, z), z),
                                      scale,
                                      pack_turn_about_y(turn),
                                      {model, uint32_t(random.next_bits())}});
            }
        make_tiles(placements, scene_);
        finish_tiles(scene_, bounds);
        return {};
    }

    // In the order of what needs what.
    Registry registry_;
    Scene scene_;
    std::vector<Plant> plants_;
    std::unique_ptr<gpu::Device> device_;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;

  public:
    std::unique_ptr<Vegetation> vegetation;

  private:
    gpu::CommandRing ring_;
};

}  // namespace coppice
