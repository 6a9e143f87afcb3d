// One packed plant drawn from any side and at any size, for measurements: depth and surface words are read back.
#pragma once
#include <memory>
#include <vector>
#include "plugins/vegetation/draw/expand_plants.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/plant/surface.h"
#include "runtime/gpu/commands.h"

namespace coppice {

// Of the pixels a plant covers.
struct PictureMean {
    double coverage_px = 0.0;
    vec3 color_linear{0.0f};  // mean over covered pixels
    double depth = 0.0;
};

class PlantPicture {
  public:
    static Result<std::unique_ptr<PlantPicture>> create(const gpu::Device& device, Plant plant,
                                                        uint32_t side) {
        std::unique_ptr<PlantPicture> picture(new PlantPicture(device, side));
        COPPICE_TRY(picture->rasteriser_, Rasteriser::create(device, picture->graph_, 1, side, side));
        COPPICE_TRY(picture->ring_, gpu::CommandRing::create(device, 1));
        Scene scene;
        scene.models.resize(1);
        std::vector<Plant> plants{std::move(plant)};
        COPPICE_TRY(picture->geometry_, gather_geometry(scene, plants));
        COPPICE_CHECK(
            picture->rasteriser_->set_geometry({picture->geometry_.vertices, picture->geometry_.owners}));
        picture->plant_ = plants[0];
        return picture;
    }

    // The plant height_px tall, seen from far away (so that perspective does not matter) in direction yaw, pitch.
    // shift_px: where it lies against the pixel grid.
    Result<PictureMean> draw(float height_px, float yaw_rad, float pitch_rad, vec2 shift_px,
                             const FrameSettings& settings) {
        const DrawModel& model = geometry_.models[0];
        Camera camera;
        camera.vertical_fov_rad = 0.05f;
        camera.yaw_rad = yaw_rad;
        camera.pitch_rad = pitch_rad;
        camera.position_world = dvec3(0.0);
        Frustum frustum = make_frustum(camera, side_, side_);
        float height_m = plant_.bounds_plant.size().y;
        float distance_m = frustum.focal_px * height_m / height_px;
        float to_m = distance_m / frustum.focal_px;
        vec3 center = frustum.forward * distance_m + frustum.right * (shift_px.x * to_m) +
                      frustum.up * (shift_px.y * to_m);
        return draw_from(camera, center - model.center_plant, true, settings);
    }

    // The plant with its foot there, relative to the camera. inside: cells are not tested against the view.
    Result<PictureMean> draw_from(const Camera& camera, vec3 foot, bool inside,
                                  const FrameSettings& settings) {
        Frustum frustum = make_frustum(camera, side_, side_);
        PlantPosition position{foot.x, foot.y, foot.z, 1.0f};
        PlantTurn turn{0, 0, 0, 32767};
        PlantModel plant_model{0, seed_ = mix_seed(seed_)};
        work_.begin(1);
        see_plants({vec3(0.0f), inside, {&position, 1}, {&turn, 1}, {&plant_model, 1}}, geometry_, frustum,
                   nullptr, 0.0f, seen_);
        draw_plants(seen_, geometry_, settings, 0, work_.part(0));
        WorkList::Size size = work_.size();
        if (size.entries > rasteriser_->entries(0).size())
            COPPICE_CHECK(rasteriser_->grow(0, size.instances, size.entries));
        WorkList::Layout layout = work_.gather(rasteriser_->instances(0), rasteriser_->entries(0));
        COPPICE_TRY(auto frame, ring_.begin());
        rasteriser_->set_frame(0, layout, camera, Light{}, {});
        graph_.record(frame.commands, frame.timestamps);
        COPPICE_CHECK(ring_.submit());
        COPPICE_CHECK(ring_.wait(frame.serial));
        words.resize(size_t(side_) * side_);
        COPPICE_CHECK(
            gpu::read_now(device_, rasteriser_->visibility(), 0, std::as_writable_bytes(std::span(words))));
        PictureMean mean;
        double sum[3] = {};
        for (uint64_t word : words) {
            if (word == 0) continue;
            mean.coverage_px += 1.0;
            vec3 color = decode_surface(uint32_t(word)).color_linear;
            for (int c = 0; c < 3; ++c) sum[c] += color[c];
        }
        if (mean.coverage_px > 0.0)
            mean.color_linear = vec3(float(sum[0] / mean.coverage_px), float(sum[1] / mean.coverage_px),
                                     float(sum[2] / mean.coverage_px));
        return mean;
    }

    const WorkPart& work() { return work_.part(0); }
    const Plant& plant() const { return plant_; }
    const DrawModel& model() const { return geometry_.models[0]; }
    std::vector<uint64_t> words;

  private:
    PlantPicture(const gpu::Device& device, uint32_t side) : device_(device), side_(side) {}
    static uint32_t mix_seed(uint32_t seed) { return seed * 0x9e3779b9u + 0x7f4a7c15u; }

    const gpu::Device& device_;
    uint32_t side_;
    FrameGraph graph_;
    std::unique_ptr<Rasteriser> rasteriser_;
    gpu::CommandRing ring_;
    SceneGeometry geometry_;
    Plant plant_;
    SeenPlants seen_;
    WorkList work_;
    uint32_t seed_ = 1;
};

}  // namespace coppice
