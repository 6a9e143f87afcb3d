#include "editor/view/editor_view.h"

#include <algorithm>
#include <chrono>
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

constexpr uint32_t k_loose_tiles = 1u << 16;  // 8 by 8 km of 32 m

uint64_t name_of(PlantCell cell) { return uint64_t(uint32_t(cell.x)) << 32 | uint32_t(cell.z); }

double ms_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

EditorView::~EditorView() { vegetation.reset(); }

Result<std::unique_ptr<EditorView>> EditorView::create(Registry& registry, Session& session,
                                                       const EditorViewSettings& settings) {
    std::unique_ptr<EditorView> view(new EditorView);
    for (const char* name : {"terrain", "modeller", "vegetation"}) COPPICE_CHECK(registry.load(name));
    view->base_settings_ = {registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version),
                            registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version),
                            [&registry]() -> const ImagesInterface* {
                                if (!registry.load("images")) return nullptr;
                                return registry.find<ImagesInterface>(k_images_interface, k_images_version);
                            },
                            settings.cache_dir.empty() ? default_cache_dir() : settings.cache_dir};
    gpu::DeviceSettings device_settings;
    device_settings.choice = settings.device;
    device_settings.validation = settings.validation;
    device_settings.present = !settings.present_extensions.empty();
    device_settings.instance_extensions = settings.present_extensions;
    COPPICE_TRY(view->device, gpu::Device::create(device_settings));
    COPPICE_TRY(view->ring, gpu::CommandRing::create(*view->device, k_frame_slots));
    const auto* interface = registry.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
    if (!interface)
        return fail(ErrorId::name_unknown, "", "plugin vegetation", "does not provide its interface",
                    "install the plugin of this version");
    VegetationSettings vegetation{view->device.get(), &view->world_,  &view->schedule_, &view->graph_,
                                  k_frame_slots,      settings.width, settings.height};
    vegetation.loose_tiles = k_loose_tiles;
    COPPICE_TRY(view->vegetation, interface->create(vegetation));
    view->width = settings.width;
    view->height = settings.height;
    // What shows the picture reads it behind the last pass.
    view->graph_.add_pass("show", {{view->vegetation->color_resource(), BufferAccess::transfer_read}}, {});
    COPPICE_CHECK(view->follow(session));
    return view;
}

Status EditorView::follow(Session& session) {
    Document& document = session.changing_document();
    unshown_.merge(document.root().plants.take_changed());
    // Strokes change plants alone, and what a base scene consists of takes time to look at.
    if (const uint64_t edits = session.text_version(); !shown_ || edits != edit_hash_) {
        edit_hash_ = edits;
        if (const uint64_t hash = hash_base(document); !shown_ || hash != base_hash_) {
            base_hash_ = hash;
            COPPICE_CHECK(show_base(session));
            unshown_.clear();
            for (const auto& [cell, plants] : document.root().plants.cells()) unshown_.insert(cell);
        }
    }
    const auto clock = std::chrono::steady_clock::now();
    Status first_fault;
    std::erase_if(unshown_, [&](const PlantCell& cell) {
        Status shown = show_cell(session, cell);
        if (!shown && first_fault) first_fault = shown;
        return shown.has_value();
    });
    times_.loose_ms = ms_since(clock);
    return first_fault;
}

Status EditorView::show_base(const Session& session) {
    COPPICE_TRY(BaseScene base, make_base_scene(session.document(), base_settings_));
    const auto clock = std::chrono::steady_clock::now();
    bounds_of_model_.clear();
    triangles_of_model_.clear();
    for (const Plant& plant : base.plants) {
        bounds_of_model_.push_back(plant.bounds_plant);
        triangles_of_model_.push_back(plant.triangle_vertices.size() / 3);
    }
    COPPICE_CHECK(vegetation->set_scene(base.scene, std::move(base.plants)));
    times_ = {base.scene_ms, base.plants_ms, base.tiles_ms, ms_since(clock), 0.0};
    base_counts_.clear();
    for (const PlantModel& plant : base.scene.plant_models)
        ++base_counts_[base.scene.models[plant.model].name];
    kinds_ = std::move(base.scene.kinds);
    box_ = base.box;
    camera_path_ = std::move(base.scene.camera_path);
    sample_distance_px_ = base.scene.sample_distance_px;
    faults_ = std::move(base.faults);
    shown_ = true;
    return {};
}

const PlantKind& EditorView::kind_of(const std::string& name) const {
    const auto found = kinds_.find(name);
    return found == kinds_.end() ? box_ : found->second;
}

Status EditorView::show_cell(const Session& session, PlantCell cell) {
    const Document& document = session.document();
    const auto found = document.root().plants.cells().find(cell);
    if (found == document.root().plants.cells().end()) return vegetation->set_loose_tile(name_of(cell), {});
    const Terrain* terrain = session.terrain();
    std::vector<Placement> placements;
    placements.reserve(found->second.size());
    double y_sum = 0.0;
    for (const PlacedPlant& plant : found->second) {
        const dvec2 at = ground_place(plant);
        placements.push_back(
            unpack_placed(plant, kind_of(document.kinds()[plant.kind]), ground_height(terrain, at.x, at.y)));
        y_sum += placements.back().position_world.y;
    }
    std::stable_sort(placements.begin(), placements.end(),
                     [](const Placement& a, const Placement& b) { return a.model.model < b.model.model; });
    Scene tile;
    tile.tiles.resize(1);
    const dvec3 origin((cell.x + 0.5) * PlantSet::k_cell_m,
                       std::floor(y_sum / double(placements.size()) * 16.0 + 0.5) / 16.0,
                       (cell.z + 0.5) * PlantSet::k_cell_m);
    for (const Placement& plant : placements) {
        const vec3 local(plant.position_world - origin);
        tile.positions.push_back({local.x, local.y, local.z, plant.scale});
        tile.turns.push_back(plant.turn);
        tile.plant_models.push_back(plant.model);
    }
    tile.tiles[0] = {{origin, {}}, 0, uint32_t(placements.size())};
    finish_tiles(tile, bounds_of_model_);
    return vegetation->set_loose_tile(name_of(cell),
                                      {tile.tiles[0].tile, tile.positions, tile.turns, tile.plant_models});
}

Result<gpu::CommandRing::Frame> EditorView::begin_frame(const Camera& camera, const FrameSettings& settings) {
    COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
    vegetation->set_slot(frame.slot);
    vegetation->set_camera(camera);
    vegetation->set_settings(settings);
    schedule_.run();
    graph_.record(frame.commands, frame.timestamps);
    last_slot_ = frame.slot;
    return frame;
}

void EditorView::tell_frame_ms(double ms) { vegetation->set_frame_ms(last_slot_, ms); }

Status EditorView::resize(uint32_t width_px, uint32_t height_px) {
    COPPICE_CHECK(vegetation->resize(width_px, height_px));
    width = width_px;
    height = height_px;
    return {};
}

double EditorView::triangles_of(const std::string& kind) const {
    double sum = 0.0;
    const PlantKind& found = kind_of(kind);
    for (const PlantIndividual& individual : found.individuals)
        sum += double(triangles_of_model_[individual.model]) / double(found.individuals.size());
    return sum;
}

double EditorView::crown_width_m(const std::string& kind) const {
    const auto found = kinds_.find(kind);
    if (found == kinds_.end()) return 0.0;
    double sum = 0.0;
    for (const PlantIndividual& individual : found->second.individuals) {
        const vec3 size = bounds_of_model_[individual.model].size() * individual.scale;
        sum += double(std::max(size.x, size.z)) / double(found->second.individuals.size());
    }
    return sum;
}

Box EditorView::bounds_of(const PlacedPlant& plant, const Document& document) const {
    const PlantKind& kind = kind_of(document.kinds()[plant.kind]);
    const PlantIndividual& individual = kind.individuals[plant.variation % kind.individuals.size()];
    Box bounds = bounds_of_model_[individual.model];
    bounds.min *= individual.scale;
    bounds.max *= individual.scale;
    return bounds;
}

size_t EditorView::base_plant_count(const std::string& kind) const {
    const auto found = base_counts_.find(kind);
    return found == base_counts_.end() ? 0 : found->second;
}

}  // namespace coppice
