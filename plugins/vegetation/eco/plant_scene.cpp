#include "plugins/vegetation/eco/plant_scene.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <fmt/format.h>
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/scatter.h"

namespace coppice {
namespace {

constexpr uint32_t k_grove_columns = 24, k_grove_rows = 16;
constexpr float k_far_height_px = 20.0f;
constexpr float k_near_share = 0.9f;  // of the picture's height that the plant fills
constexpr float k_climb = 0.12f;      // m up a metre back, so that the grove is seen behind the plant
constexpr int k_key_count = 7;
constexpr double k_key_step_s = 2.0;

// What the plant measures, at least a millimetre, so that every distance below is more than none.
struct PlantSize {
    float height_m, width_m;
    // What has to fit into the picture's height: a carpet is seen by its width, in a picture wider than tall.
    float seen_m() const { return std::max(height_m, 0.5f * width_m); }
    float spacing_m() const { return 1.05f * std::max(width_m, 0.25f * height_m); }
};

PlantSize size_of(const Box& bounds) {
    constexpr float k_least_m = 1e-3f;
    vec3 size = bounds.size();
    return {std::max(size.y, k_least_m), std::max({size.x, size.z, k_least_m})};
}

std::vector<CameraKey> fly_away(const PlantSize& size, uint32_t picture_height_px) {
    Camera camera;
    float half_angle_rad = 0.5f * camera.vertical_fov_rad;
    float tangent = portable_sin(half_angle_rad) / portable_cos(half_angle_rad);
    float near_m = 0.5f * size.seen_m() / (k_near_share * tangent) + 0.5f * size.width_m;
    float far_m =
        std::max(size.seen_m() * float(picture_height_px) / (2.0f * tangent * k_far_height_px), near_m);
    camera.near_m = std::min(camera.near_m, 0.05f * near_m);
    std::vector<CameraKey> keys;
    for (int k = 0; k < k_key_count; ++k) {
        float distance_m = near_m * portable_pow(far_m / near_m, float(k) / float(k_key_count - 1));
        float above_m = k_climb * (distance_m - near_m);
        camera.position_world = dvec3(0.0, 0.5f * size.height_m + above_m, distance_m);
        camera.pitch_rad = portable_atan2(-above_m, distance_m);
        keys.push_back({k_key_step_s * double(k), camera});
    }
    return keys;
}

Result<std::vector<Placement>> plant_grove(const PlantSize& size, const std::string& path) {
    ScatterSettings grove;
    grove.species.push_back({PlantKind{}, 1.0f});
    grove.grid_spacing_m = double(size.spacing_m());
    grove.grid_jitter_m = 0.25 * grove.grid_spacing_m;
    grove.grid_columns = k_grove_columns;
    grove.grid_rows = k_grove_rows;
    grove.scale_low = 0.8f;
    grove.scale_high = 1.2f;
    RegionShape ground;
    ground.kind = RegionShape::Kind::rectangle;
    ground.center = dvec2(0.0, -grove.grid_spacing_m * (0.5 * k_grove_rows + 2.0));
    ground.half_size = dvec2(k_grove_columns, k_grove_rows) * grove.grid_spacing_m;
    grove.region.shapes.push_back(ground);
    return scatter(grove, path, "grove");
}

}  // namespace

bool is_plant_file(const std::string& path) {
    std::string name = path;
    for (char& c : name)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    if (name.ends_with(".json")) return !name.ends_with(".eco.json");
    return name.ends_with(".glb") || name.ends_with(".gltf") || name.ends_with(".plant");
}

SceneModel plant_scene_model(const std::string& path) {
    return {std::filesystem::path(path).stem().string(), path, 0, 1.0f};
}

Result<Scene> make_plant_scene(const std::string& path, const Box& bounds_plant, uint32_t picture_height_px,
                               const TerrainInterface* terrain) {
    assert(!bounds_plant.empty() && picture_height_px > 0);
    PlantSize size = size_of(bounds_plant);
    Scene scene;
    scene.path = path;
    scene.models.push_back(plant_scene_model(path));
    scene.name = scene.models.front().name;
    scene.camera_path = fly_away(size, picture_height_px);
    COPPICE_TRY(std::vector<Placement> plants, plant_grove(size, path));
    plants.push_back({dvec3(0.0), 1.0f, pack_turn_about_y(0.0f), {0, 1}});
    vec3 foot(bounds_plant.center().x, bounds_plant.min.y, bounds_plant.center().z);
    for (Placement& plant : plants)
        plant.position_world -= dvec3(rotation_matrix(plant.turn) * foot * plant.scale);
    make_tiles(plants, scene);
    if (terrain) {
        double reach_m = scene.camera_path.back().camera.position_world.z + 40.0 * double(size.spacing_m());
        double side_m = std::clamp(4.0 * reach_m, 1.0, 100'000.0);
        std::string json = fmt::format(R"({{"flat": {{"size_m": {}, "cell_m": {}}}}})", side_m,
                                       std::clamp(side_m / 128.0, 0.05, 1000.0));
        COPPICE_TRY(scene.terrain, terrain->load(json, "", path));
    }
    return scene;
}

}  // namespace coppice
