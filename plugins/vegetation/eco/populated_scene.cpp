#include "plugins/vegetation/eco/populated_scene.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/mosaic.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

using nlohmann::ordered_json;

constexpr uint64_t k_format = 3;
constexpr const char* k_remedy = "populate the scene again";
constexpr uint64_t k_most_count = uint64_t(1) << 53;  // what JSON numbers hold

template <class V>
ordered_json numbers_of(const V& v) {
    return {v.x, v.y, v.z};
}

ordered_json json_of(const Light& light) {
    return {{"direction_to_sun", numbers_of(light.direction_to_sun)},
            {"sun", numbers_of(light.sun_color)},
            {"sky_zenith", numbers_of(light.sky_zenith_color)},
            {"sky_horizon", numbers_of(light.sky_horizon_color)},
            {"ground", numbers_of(light.ground_color)},
            {"haze", numbers_of(light.haze_color)},
            {"haze_density_per_m", light.haze_density_per_m},
            {"exposure", light.exposure}};
}

ordered_json json_of(const CameraKey& key) {
    return {{"time_s", key.time_s},
            {"at", numbers_of(key.camera.position_world)},
            {"yaw_rad", key.camera.yaw_rad},
            {"pitch_rad", key.camera.pitch_rad},
            {"fov_rad", key.camera.vertical_fov_rad},
            {"near_m", key.camera.near_m}};
}

vec3 read_vec3(JsonObject& object, const char* key, double low, double high) {
    const std::vector<double> v = object.numbers(key, 3, low, high);
    return vec3(v[0], v[1], v[2]);
}

Light read_light(JsonObject object) {
    Light light;
    light.direction_to_sun = read_vec3(object, "direction_to_sun", -1e6, 1e6);
    light.sun_color = read_vec3(object, "sun", 0.0, 1e6);
    light.sky_zenith_color = read_vec3(object, "sky_zenith", 0.0, 1e6);
    light.sky_horizon_color = read_vec3(object, "sky_horizon", 0.0, 1e6);
    light.ground_color = read_vec3(object, "ground", 0.0, 1e6);
    light.haze_color = read_vec3(object, "haze", 0.0, 1e6);
    light.haze_density_per_m = object.real("haze_density_per_m", 0.0f, 1e6f);
    light.exposure = object.real("exposure", 1e-6f, 1e6f);
    object.close();
    return light;
}

CameraKey read_key(JsonObject object) {
    CameraKey key;
    key.time_s = object.number("time_s", -1e9, 1e9);
    const std::vector<double> at = object.numbers("at", 3, -k_origin_reach_m, k_origin_reach_m);
    key.camera.position_world = dvec3(at[0], at[1], at[2]);
    key.camera.yaw_rad = object.real("yaw_rad", -1e4f, 1e4f);
    key.camera.pitch_rad = object.real("pitch_rad", -1e4f, 1e4f);
    key.camera.vertical_fov_rad = object.real("fov_rad", 1e-4f, 3.14f);
    key.camera.near_m = object.real("near_m", 1e-6f, 1e6f);
    object.close();
    return key;
}

void read_packs(JsonObject& root, const std::filesystem::path& folder, PopulatedScene& populated) {
    auto resolve = [&folder](const std::string& name) { return (folder / name).lexically_normal().string(); };
    for (JsonObject& object : root.objects("packs")) {
        ScenePack& pack = populated.packs.emplace_back();
        pack.path = resolve(object.text("file"));
        pack.content_hash = read_content_hash(object);
        pack.plant_count = object.whole("plants", 0, k_most_count);
        pack.triangle_count = object.whole("triangles", 0, k_most_count);
        object.close();
    }
    for (JsonObject& object : root.objects("plants")) {
        SceneModel& model = populated.scene.models.emplace_back();
        model.name = object.text("name");
        model.source_path = resolve(object.text("file"));
        populated.model_content_hashes.push_back(read_content_hash(object));
        model.importance = object.real("importance", 0.001f, 1000.0f);
        if (object.has("color_variation")) {
            JsonObject color = object.object("color_variation");
            model.color_variation = read_color_variation(color);
        }
        object.close();
    }
}

}  // namespace

std::string populated_scene_file(const std::string& path) {
    constexpr const char* k_name = "scene.json";
    std::error_code error;
    const std::filesystem::path given(path);
    if (std::filesystem::is_directory(given, error)) return (given / k_name).string();
    return given.filename() == k_name ? path : "";
}

std::string write_populated_scene(const PopulatedScene& populated) {
    const Scene& scene = populated.scene;
    assert(populated.model_content_hashes.size() == scene.models.size());
    ordered_json packs = ordered_json::array(), plants = ordered_json::array(), keys = ordered_json::array();
    for (const ScenePack& pack : populated.packs)
        packs.push_back({{"file", pack.path},
                         {"content", hash_to_hex(pack.content_hash)},
                         {"plants", pack.plant_count},
                         {"triangles", pack.triangle_count}});
    for (size_t m = 0; m < scene.models.size(); ++m) {
        plants.push_back({{"name", scene.models[m].name},
                          {"file", scene.models[m].source_path},
                          {"content", hash_to_hex(populated.model_content_hashes[m])},
                          {"importance", scene.models[m].importance}});
        if (const ColorVariation& color = scene.models[m].color_variation; color.any())
            plants.back()["color_variation"] = {{"brightness", color.brightness},
                                                {"hue_deg", color.hue_deg},
                                                {"saturation", color.saturation}};
    }
    for (const CameraKey& key : scene.camera_path) keys.push_back(json_of(key));
    ordered_json root = {{"populated", k_format}, {"name", scene.name}};
    if (populated.mosaic.empty()) {
        root["packs"] = std::move(packs);
        root["plants"] = std::move(plants);
    }
    for (const PlacedScene& placed : populated.mosaic) root["mosaic"].push_back(json_of(placed));
    root["light"] = json_of(scene.light);
    root["camera_path"] = std::move(keys);
    root["sample_distance_px"] = scene.sample_distance_px;
    if (!populated.terrain_json.empty()) root["terrain"] = nlohmann::json::parse(populated.terrain_json);
    // A name that is not UTF-8 must not throw.
    return root.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<PopulatedScene> load_populated_scene(const std::string& path, const TerrainInterface* terrain) {
    COPPICE_TRY(const std::string text, read_text_file(path));
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(text, path));
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    JsonObject root(document, document.root(), "");
    if (!root.has("populated"))
        return fail(ErrorId::format_unknown, path, "", "not a populated scene",
                    "name the scene.json of a folder that coppice populate made");
    if (const uint64_t format = root.whole("populated", 1, k_most_count);
        document.sound() && format != k_format)
        return fail(ErrorId::format_unknown, path, "populated", fmt::format("version {}", format),
                    fmt::format("this program reads version {}; {}", k_format, k_remedy));
    PopulatedScene populated;
    populated.content_hash = hash_text(text);
    Scene& scene = populated.scene;
    scene.path = path;
    scene.name = root.text("name");
    scene.sample_distance_px = root.real("sample_distance_px", 0.01f, 1000.0f);
    if (root.has("mosaic"))
        populated.mosaic = read_placed_scenes(root, folder, true);
    else
        read_packs(root, folder, populated);
    scene.light = read_light(root.object("light"));
    for (JsonObject& object : root.objects("camera_path")) {
        const CameraKey key = read_key(object);
        if (!scene.camera_path.empty() && !(key.time_s > scene.camera_path.back().time_s))
            object.report(ErrorId::value_out_of_range, "time_s", "not later than the key before", k_remedy);
        scene.camera_path.push_back(key);
    }
    if (scene.camera_path.empty())
        root.report(ErrorId::value_out_of_range, "camera_path", "no key", k_remedy);
    const nlohmann::json* ground = populated.mosaic.empty() ? root.find("terrain") : nullptr;
    root.close();
    COPPICE_CHECK(document.status());
    if (!ground) return populated;
    populated.terrain_json = ground->dump();
    if (!terrain)
        return fail(ErrorId::name_unknown, path, "terrain", "the terrain plugin is not loaded", "install it");
    COPPICE_TRY(scene.terrain, terrain->load(populated.terrain_json, folder.string(), path));
    return populated;
}

Status check_plants(const PopulatedScene& populated, std::span<const Plant> plants) {
    const std::vector<SceneModel>& models = populated.scene.models;
    assert(plants.size() == models.size());
    for (size_t m = 0; m < models.size(); ++m)
        if (plants[m].content_hash != populated.model_content_hashes[m])
            return fail(ErrorId::file_corrupt, models[m].source_path, "",
                        "not the plant the scene was populated with", k_remedy);
    return {};
}

Result<std::vector<TilePack>> open_packs(const PopulatedScene& populated) {
    std::vector<TilePack> packs;
    for (const ScenePack& expected : populated.packs) {
        COPPICE_TRY(TilePack pack, open_tile_pack(expected.path));
        if (pack.content_hash != expected.content_hash)
            return fail(ErrorId::file_corrupt, expected.path, "head",
                        "not the tiles the scene was populated with", k_remedy);
        auto same = [](const TileModel& model, uint64_t hash) { return model.content_hash == hash; };
        if (!std::equal(pack.models.begin(), pack.models.end(), populated.model_content_hashes.begin(),
                        populated.model_content_hashes.end(), same))
            return fail(ErrorId::file_corrupt, expected.path, "models", "not the plants of the scene",
                        k_remedy);
        packs.push_back(std::move(pack));
    }
    return packs;
}

}  // namespace coppice
