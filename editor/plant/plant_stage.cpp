#include "editor/plant/plant_stage.h"

#include <algorithm>
#include "plugins/vegetation/cull/frustum.h"

namespace coppice {
namespace {

constexpr uint32_t k_frame_slots = 2;
constexpr float k_enough_importance = 1.0e6f;  // at which nothing but triangles does
constexpr float k_free_height = 0.74f;         // of the window
constexpr float k_fov_rad = 0.03f;             // so far away that the plant is drawn as a whole, not by octree cells
constexpr uint64_t k_tile_name = 1;
const char* const k_all_triangles = "all triangles";

}  // namespace

Result<std::unique_ptr<PlantStage>> PlantStage::create(const gpu::Device& device, Registry& registry,
                                                       uint32_t width, uint32_t height) {
    std::unique_ptr<PlantStage> stage(new PlantStage);
    const auto* interface = registry.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
    if (!interface)
        return fail(ErrorId::name_unknown, "", "plugin vegetation", "does not provide its interface",
                    "install the plugin of this version");
    VegetationSettings settings{&device, &stage->world_, &stage->schedule_, &stage->graph_, k_frame_slots, width, height};
    settings.loose_tiles = 1;
    COPPICE_TRY(stage->vegetation_, interface->create(settings));
    stage->graph_.add_pass("show", {{stage->vegetation_->color_resource(), BufferAccess::transfer_read}}, {});
    stage->width_ = width;
    stage->height_ = height;
    return stage;
}

Status PlantStage::show(const Plant& plant, const std::map<uint32_t, float>& importance) {
    std::vector<PackedPart> parts(plant.parts.begin(), plant.parts.end()), cells(plant.cells.begin(), plant.cells.end());
    for (const auto& [part, tried] : importance) {
        if (part < parts.size()) parts[part].importance = tried;
        for (PackedPart& cell : cells)
            if (cell.part == part) cell.importance = tried;
    }
    Plant levels = plant;
    levels.parts = parts;
    levels.cells = cells;
    Scene scene;
    scene.path = plant.name;
    scene.light.haze_density_per_m = 0.0f;  // the viewer is far away
    scene.models = {{k_all_triangles, "", 0, k_enough_importance}, {plant.name, "", 0, 1.0f}};
    COPPICE_CHECK(vegetation_->set_scene(scene, {plant, levels}));
    bounds_m_ = plant.bounds_plant;
    size_m_ = glm::max(plant.bounds_plant.size(), vec3(1e-4f));
    center_m_ = vec3(0.0f, plant.bounds_plant.center().y, 0.0f);
    return {};
}

Status PlantStage::resize(uint32_t width, uint32_t height) {
    COPPICE_CHECK(vegetation_->resize(width, height));
    width_ = width;
    height_ = height;
    return {};
}

Result<gpu::CommandRing::Frame> PlantStage::begin_frame(gpu::CommandRing& ring, const StageView& view,
                                                        float free_low_px, float free_high_px) {
    Camera camera;
    camera.vertical_fov_rad = k_fov_rad;
    camera.yaw_rad = view.yaw_rad;
    camera.pitch_rad = view.pitch_rad;
    const Frustum frustum = make_frustum(camera, width_, height_);
    const float wide_m = std::max(size_m_.x, size_m_.z), apart_m = 0.55f * wide_m;
    const float fit_px = std::min(k_free_height * float(height_) / size_m_.y,
                                  std::max(free_high_px - free_low_px, 1.0f) / (2.0f * apart_m + wide_m)) *
                         size_m_.y * view.zoom;
    shown_px_ = view.own_size ? view.height_px : fit_px;
    const float away_m = frustum.focal_px * size_m_.y / std::max(shown_px_, 0.1f);
    const float off_m = 0.5f * (float(width_) - free_low_px - free_high_px) * away_m / frustum.focal_px;
    camera.position_world = dvec3(center_m_ - frustum.forward * away_m + frustum.right * off_m);
    camera.near_m = std::min(camera.near_m, 0.05f * away_m);
    settings_ = {};
    settings_.sample_distance_px = std::clamp(shown_px_ / std::max(view.height_px, 0.1f), 0.02f, 200.0f);
    settings_.most_sample_distance_px = settings_.sample_distance_px;
    settings_.view = view.kinds ? RepresentationView::kinds : RepresentationView::lit;
    settings_.shadows = view.shadows ? ShadowKind::clipmap : ShadowKind::none;
    settings_.shadow_distance_m = 2.0f * away_m + size_m_.y;
    // A view at rest falls to finer levels than the one that is asked for.
    settings_.accumulate_limit = 0;

    // However the viewer walks around them, they stand side by side.
    if (!is_empty()) {
        const vec3 beside = vec3(frustum.right.x, 0.0f, frustum.right.z) * apart_m;
        const PlantPosition positions[] = {{-beside.x, 0.0f, -beside.z, 1.0f}, {beside.x, 0.0f, beside.z, 1.0f}};
        const PlantTurn upright = pack_turn_about_y(0.0f);
        const PlantTurn turns[] = {upright, upright};
        const PlantModel models[] = {{0, 1}, {1, 1}};
        Box bounds;
        for (const PlantPosition& at : positions)
            bounds.include(Box{vec3(at.x_tile, 0.0f, at.z_tile) + bounds_m_.min,
                               vec3(at.x_tile, 0.0f, at.z_tile) + bounds_m_.max});
        COPPICE_CHECK(
            vegetation_->set_loose_tile(k_tile_name, {{dvec3(0.0), bounds, 2}, positions, turns, models}));
    }
    COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
    vegetation_->set_slot(frame.slot);
    vegetation_->set_camera(camera);
    vegetation_->set_settings(settings_);
    schedule_.run();
    graph_.record(frame.commands, frame.timestamps);
    return frame;
}

PrimitiveCounts PlantStage::drawn() const {
    PrimitiveCounts counts;
    for (const ExplainedPlants& row : vegetation_->explain_frame().plants) {
        if (row.model == k_all_triangles) continue;
        counts.triangles += row.drawn.triangles;
        counts.lines += row.drawn.lines;
        counts.points += row.drawn.points;
        counts.leaves += row.drawn.leaves;
    }
    return counts;
}

}  // namespace coppice
