#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include "plugins/images/images.h"
#include "plugins/modeller/grow.h"
#include "plugins/modeller/species.h"
#include "plugins/terrain/ground_file.h"
#include "plugins/terrain/load_terrain.h"
#include "plugins/terrain/read_heights.h"
#include "plugins/vegetation/cook/import/import_gltf.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/place_named.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/eco/read_placements_csv.h"
#include "plugins/vegetation/eco/tile_pack.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/picture.h"
#include "runtime/plugin/registry.h"
#include "tests/hostile/reader.h"
#include "tests/hostile/require.h"
#include "tests/hostile/scratch.h"

namespace coppice::hostile {
namespace {

constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
constexpr double k_grown_triangle_limit = 20'000;  // beyond it, growing takes long and shows nothing new

bool all_finite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require_description(const PlantDescription& plant) {
    for (const PartDescription& part : plant.parts) {
        require(part.indices.size() % 3 == 0, "triangles have three corners");
        for (const uint32_t index : part.indices)
            require(index < part.vertices.size(), "corners are vertices");
        for (const DescriptionVertex& vertex : part.vertices) {
            for (int axis = 0; axis < 3; ++axis) {
                require(std::fabs(vertex.position_plant[axis]) <= k_position_limit_m,
                        "positions are near and finite");
                require(std::isfinite(vertex.normal_plant[axis]), "normals are finite");
                require(vertex.color_linear[axis] >= 0.0f && vertex.color_linear[axis] <= 1.0f,
                        "colours are in [0, 1]");
            }
        }
    }
}

void require_path(const std::vector<CameraKey>& keys) {
    require(!keys.empty(), "a path has a key");
    for (size_t i = 1; i < keys.size(); ++i) require(keys[i].time_s > keys[i - 1].time_s, "times grow");
    for (int i = 0; i <= 8; ++i) {
        const Camera camera = camera_at(keys, keys.back().time_s * i / 8.0);
        require(all_finite(camera.position_world) && std::isfinite(camera.yaw_rad) &&
                    std::isfinite(camera.pitch_rad),
                "cameras stand somewhere");
    }
}

bool read_heights_as(const char* name, std::span<const std::byte> bytes) {
    const Scratch file(name, bytes);
    const Result<HeightField> field = read_heights(file.path(), {});
    if (!accepted(field)) return false;
    require(field->heights_m.size() == size_t(field->columns) * field->rows && field->columns >= 2 &&
                field->rows >= 2,
            "a field has its heights");
    for (const float height_m : field->heights_m) require(std::isfinite(height_m), "heights are finite");
    require(std::isfinite(field->height_at(0.3f, -0.7f)), "the middle has a height");
    return true;
}

const ImagesInterface* images() {
    static Registry registry;
    static const bool k_loaded = registry.load("images").has_value();
    return k_loaded ? registry.find<ImagesInterface>(k_images_interface, k_images_version) : nullptr;
}

}  // namespace

bool read_gltf(std::span<const std::byte> bytes) {
    ImportSettings settings;
    settings.images = images();
    settings.size_limit_bytes = 1 << 24;
    settings.vertex_limit = 1 << 18;
    settings.triangle_limit = 1 << 18;
    const auto plant = import_gltf_memory(bytes, "hostile.gltf", "/nonexistent", settings);
    if (!accepted(plant)) return false;
    require_description(*plant);
    return true;
}

bool read_gltf_places(std::span<const std::byte> bytes) {
    const auto named = read_named_places_memory(bytes, "hostile.gltf", "/nonexistent", 1 << 24);
    if (!accepted(named)) return false;
    for (const NamedPlaces& many : *named) {
        require(!many.names.empty() && many.names.size() <= 2, "places are called something");
        for (const NamedPlace& place : many.places) {
            require(all_finite(place.at) && std::isfinite(place.scale) && place.scale > 0.0, "they are somewhere");
            require(std::fabs(glm::length(place.turn) - 1.0f) < 1e-3f, "turns are unit");
        }
    }
    PlaceNamedSettings settings;
    settings.kinds["oak"] = {};
    if (const auto plants = place_named(*named, settings, "hostile.gltf"))
        for (const Placement& plant : *plants)
            require(all_finite(plant.position_world) && plant.scale > 0.0f && std::isfinite(plant.scale) &&
                        plant.model.model == 0,
                    "plants stand somewhere");
    return true;
}

bool read_species(std::span<const std::byte> bytes) {
    const auto species = modeller::parse_species(as_text(bytes), "hostile.json");
    if (!accepted(species)) return false;
    const double bound = modeller::triangle_bound(*species);
    require(bound >= 0.0, "triangles can be counted");
    if (bound > k_grown_triangle_limit) return true;
    const auto plant = modeller::grow_plant(as_text(bytes), "hostile.json", 3);
    if (!accepted(plant)) return false;
    size_t triangles = 0;
    for (const PartDescription& part : plant->parts) triangles += part.indices.size() / 3;
    require(double(triangles) <= bound, "a plant grows no more than its bound");
    require_description(*plant);
    return true;
}

bool read_scene(std::span<const std::byte> bytes) {
    SceneLoadSettings settings{&k_terrain};
    settings.read_file = [&](const std::string& path) -> Result<std::string> {
        if (path == "/nonexistent/hostile.eco.json") return std::string(as_text(bytes));
        return fail(ErrorId::file_missing, path, "", "no such file", "check the path");
    };
    const auto scene = load_scene("/nonexistent/hostile.eco.json", settings);
    if (!accepted(scene)) return false;
    require(scene->positions.size() == scene->turns.size() &&
                scene->positions.size() == scene->plant_models.size(),
            "plants have a place, a turn and a model");
    for (const PlantModel& model : scene->plant_models)
        require(model.model < scene->models.size(), "models are there");
    for (const SceneTile& tile : scene->tiles)
        require(uint64_t(tile.first_plant) + tile.plant_count <= scene->positions.size(),
                "tiles have their plants");
    for (const PlantPosition& position : scene->positions)
        require(std::isfinite(position.x_tile) && std::isfinite(position.y_tile) &&
                    std::isfinite(position.z_tile) && position.scale > 0.0f,
                "plants stand somewhere");
    require_path(scene->camera_path);
    return true;
}

bool read_csv(std::span<const std::byte> bytes) {
    const Scratch file("hostile.csv", bytes);
    CsvSettings settings;
    settings.kinds["oak"].height_m = 10.0f;
    settings.kinds["QURO"] = {};
    const auto placements = read_placements_csv(file.path(), settings);
    if (!accepted(placements)) return false;
    for (const Placement& placement : *placements)
        require(all_finite(placement.position_world) && placement.scale > 0.0f &&
                    std::isfinite(placement.scale) && placement.model.model == 0,
                "plants stand somewhere");
    return true;
}

bool read_path(std::span<const std::byte> bytes) {
    const Scratch file("hostile.json", bytes);
    const auto keys = load_camera_path(file.path());
    if (!accepted(keys)) return false;
    require_path(*keys);
    return true;
}

bool read_plant(std::span<const std::byte> bytes) {
    const auto memory = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
    const auto plant = load_plant_from_memory(memory, "hostile.plant");
    if (!accepted(plant)) return false;
    // All that drawing indexes by.
    float sum = 0.0f;
    for (const auto parts : {plant->parts, plant->cells})
        for (const PackedPart& part : parts) {
            for (const auto& vertex : plant->triangle_vertices.subspan(size_t(3) * part.first_triangle,
                                                                       size_t(3) * part.triangle_count))
                sum += vertex.x_plant;
            for (const auto& vertex : plant->points.subspan(part.first_point, part.point_count))
                sum += vertex.y_plant;
            for (const uint32_t owner : plant->point_owners.subspan(part.first_point, part.point_count))
                require(owner < part.triangle_count, "points lie on triangles");
            for (const auto& vertex :
                 plant->line_vertices.subspan(size_t(2) * part.first_line, size_t(2) * part.line_count))
                sum += vertex.z_plant;
            require(gain_at(part, 0.3f) > 0.0f, "gains are positive");
        }
    require(std::isfinite(sum), "positions are finite");
    return true;
}

bool read_placed(std::span<const std::byte> bytes) {
    const auto placed = coppice::read_placed(as_text(bytes), "hostile.plants");
    if (!accepted(placed)) return false;
    for (const PlacedPlant& plant : placed->plants) {
        require(plant.kind < placed->kinds.size(), "kinds are named");
        const float scale = unpack_scale(plant.scale);
        require(std::isfinite(scale), "scales are finite");
        unpack_placed_turn(plant.turn);
    }
    require(accepted(coppice::read_placed(write_placed(*placed), "again.plants")),
            "what was read can be written");
    return true;
}

bool read_tiles(std::span<const std::byte> bytes) {
    const Scratch file("hostile.tiles", bytes);
    const auto pack = open_tile_pack(file.path());
    if (!accepted(pack) || !accepted(check_blocks(*pack))) return false;
    for (uint32_t node = 0; node < pack->nodes.size(); ++node) {
        const auto plants = read_plants(*pack, node);
        require(plants.has_value(), "blocks that were checked can be read");
        for (const PlantModel& model : plants->models)
            require(model.model < pack->models.size(), "models are there");
    }
    return true;
}

bool read_world(std::span<const std::byte> bytes) {
    const Scratch file("scene.json", bytes);
    const auto world = load_populated_scene(file.path(), &k_terrain);
    if (!accepted(world)) return false;
    require_path(world->scene.camera_path);
    require(world->model_content_hashes.size() == world->scene.models.size(), "models have their hashes");
    return true;
}

bool read_terrain(std::span<const std::byte> bytes) {
    const auto terrain = load_terrain(as_text(bytes), "/nonexistent", "hostile.eco.json");
    if (!accepted(terrain)) return false;
    require(std::isfinite((*terrain)->height_at(1.0f, -2.0f)), "the ground is somewhere");
    for (const TerrainPatch& patch : (*terrain)->patches())
        require(size_t(patch.first_level) + patch.level_count <= (*terrain)->levels().size(),
                "patches have their levels");
    return true;
}

bool read_pgm(std::span<const std::byte> bytes) { return read_heights_as("hostile.pgm", bytes); }
bool read_heights_pfm(std::span<const std::byte> bytes) { return read_heights_as("hostile.pfm", bytes); }
bool read_r16(std::span<const std::byte> bytes) { return read_heights_as("hostile.r16", bytes); }

bool read_ground(std::span<const std::byte> bytes) {
    const Scratch file("hostile.ground", bytes);
    const auto ground = coppice::read_ground(file.path());
    if (!accepted(ground)) return false;
    require(ground->field.heights_m.size() == size_t(ground->field.columns) * ground->field.rows,
            "a field has its heights");
    require(ground->words.size() == ground->mesh.word_count, "a ground has its look");
    return true;
}

bool read_ppm(std::span<const std::byte> bytes) {
    const Scratch file("hostile.ppm", bytes);
    const auto picture = coppice::read_ppm(file.path());
    if (!accepted(picture)) return false;
    require(!picture->empty() && picture->rgba.size() == size_t(4) * picture->width * picture->height,
            "pixels are there");
    return true;
}

bool read_pnm(std::span<const std::byte> bytes) {
    const Scratch file("hostile.pnm", bytes);
    const auto picture = coppice::read_pnm(file.path());
    if (!accepted(picture)) return false;
    require(picture->rgb.size() == size_t(3) * picture->width * picture->height, "pixels are there");
    for (const float value : picture->rgb) require(value >= 0.0f && value <= 1.0f, "values are shares");
    return true;
}

bool read_pfm(std::span<const std::byte> bytes) {
    const Scratch file("hostile.pfm", bytes);
    const auto picture = coppice::read_pfm(file.path());
    if (!accepted(picture)) return false;
    require(picture->rgb.size() == size_t(3) * picture->width * picture->height, "pixels are there");
    return true;
}

bool read_png(std::span<const std::byte> bytes) {
    if (!images()) return false;
    const auto picture = images()->read_memory(bytes, "hostile.png");
    if (!accepted(picture)) return false;
    require(!picture->empty() && picture->rgba.size() == size_t(4) * picture->width * picture->height,
            "pixels are there");
    return true;
}

}  // namespace coppice::hostile
