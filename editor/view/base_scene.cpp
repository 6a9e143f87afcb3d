#include "editor/view/base_scene.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <fmt/format.h>
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/cook/part_settings.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/scene_file.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

using Json = nlohmann::ordered_json;

constexpr int k_fault_limit = 256;  // more are not looked for one by one

double ms_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

// Without the placement of what is placed one by one.
Json without_placed(Json json) {
    auto placements = json.find("placements");
    if (placements == json.end() || !placements->is_array()) return json;
    for (size_t i = 0; i < placements->size(); ++i)
        if ((*placements)[i].is_object() && (*placements)[i].contains("packed")) {
            placements->erase(i);
            break;
        }
    return json;
}

// The scene's texts, from which faulty pieces are taken out until the rest loads.
class Texts {
  public:
    explicit Texts(const Document& document) : document_(document) {
        for (const auto& [path, file] : document.files()) {
            if (!file.text) continue;
            texts_[path] = path == document.root_path() ? without_placed(file.text->json) : file.text->json;
        }
    }

    Result<std::string> read(const std::string& path) const {
        if (auto text = texts_.find(path); text != texts_.end()) return text->second.dump();
        for (const auto& [scene, file] : document_.files())
            if (file.text && file.placed_path == path)
                if (auto plants = document_.plants_bytes(file)) return *plants;
        return read_scene_bytes(path, {});
    }

    // False: it is not known what is at fault.
    bool drop(const Error& error) {
        if (auto text = texts_.find(error.file); text != texts_.end()) return drop_place(text->second, error);
        // Of another file: whatever names it.
        bool dropped = false;
        for (auto& [path, json] : texts_) dropped |= drop_names_of(json, path, error.file);
        return dropped;
    }

  private:
    static bool drop_place(Json& json, const Error& error) {
        const std::string& place = error.place;
        const std::string key = place.substr(0, place.find_first_of(".["));
        auto found = json.find(key);
        if (place.empty()) {
            // "unknown key 'x'"
            const size_t open = error.fault.find('\''), close = error.fault.rfind('\'');
            return open < close && json.erase(error.fault.substr(open + 1, close - open - 1)) > 0;
        }
        if (found == json.end()) return false;
        if (found->is_array() && place.size() > key.size() && place[key.size()] == '[') {
            const size_t index = std::strtoull(place.c_str() + key.size() + 1, nullptr, 10);
            if (index >= found->size()) return false;
            (*found).erase(index);
            return true;
        }
        if (found->is_object() && (key == "plants" || key == "regions") && place.size() > key.size()) {
            const std::string rest = place.substr(key.size() + 1);
            for (const auto& [name, ignored] : found->items())
                if (rest == name || rest.starts_with(name + ".") || rest.starts_with(name + "[")) {
                    const std::string gone = name;
                    found->erase(gone);
                    return true;
                }
        }
        json.erase(key);
        // Without them a scene is none.
        if (key == "plants") json[key] = Json::object();
        if (key == "placements") json[key] = Json::array();
        return true;
    }

    static bool names(const Json& value, const std::string& from, const std::string& path) {
        if (value.is_string()) return Document::resolve(from, value.get<std::string>()) == path;
        if (!value.is_structured()) return false;
        return std::any_of(value.begin(), value.end(),
                           [&](const Json& item) { return names(item, from, path); });
    }

    static bool drop_names_of(Json& json, const std::string& from, const std::string& path) {
        bool dropped = false;
        for (const char* key : {"placements", "references"}) {
            auto list = json.find(key);
            if (list == json.end() || !list->is_array()) continue;
            for (size_t i = list->size(); i-- > 0;)
                if (names((*list)[i], from, path)) {
                    list->erase(i);
                    dropped = true;
                }
        }
        if (auto plants = json.find("plants"); plants != json.end() && plants->is_object()) {
            std::vector<std::string> gone;
            for (const auto& [name, entry] : plants->items())
                if (names(entry, from, path)) gone.push_back(name);
            for (const std::string& name : gone) plants->erase(name);
            dropped |= !gone.empty();
        }
        for (const char* key : {"terrain", "camera_path"})
            if (auto found = json.find(key); found != json.end() && names(*found, from, path)) {
                json.erase(key);
                dropped = true;
            }
        return dropped;
    }

    const Document& document_;
    std::map<std::string, Json> texts_;
};

// A cube of a metre, of a colour that no plant has. Kept in the cache: cooking it takes longer than finding all plants.
Result<Plant> find_or_make_box(const std::string& cache_dir) {
    const CookSettings settings;
    const std::string path = fmt::format("{}/missing-{:016x}.plant", cache_dir, hash_settings(settings));
    if (auto kept = load_plant(path)) return kept;
    PlantDescription description;
    description.name = "missing plant";
    PartDescription part;
    part.name = "box";
    for (int axis = 0; axis < 3; ++axis)
        for (float side : {-1.0f, 1.0f}) {
            vec3 normal(0.0f), u(0.0f), v(0.0f);
            normal[axis] = side;
            u[(axis + 1) % 3] = 0.5f;
            v[(axis + 2) % 3] = 0.5f * side;
            const uint32_t first = uint32_t(part.vertices.size());
            for (const vec3& corner : {-u - v, u - v, u + v, -u + v})
                part.vertices.push_back(
                    {normal * 0.5f + corner + vec3(0.0f, 0.5f, 0.0f), normal, vec3(0.8f, 0.05f, 0.6f)});
            for (uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) part.indices.push_back(first + i);
        }
    description.parts.push_back(std::move(part));
    COPPICE_TRY(std::vector<std::byte> bytes, cook_plant(description, settings));
    // Without a cache it is made each time.
    (void)write_file(path, bytes);
    return load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(bytes)),
                                  "missing plant");
}

Result<Scene> load_what_can_be(Texts& texts, const std::string& path, const BaseSceneSettings& settings,
                               std::vector<Error>& faults) {
    SceneLoadSettings load{settings.terrain, settings.modeller, settings.cache_dir,
                           [&](const std::string& file) { return texts.read(file); }, settings.find_images, read_named_places};
    while (true) {
        Result<Scene> scene = load_scene(path, load);
        if (scene || faults.size() >= k_fault_limit) return scene;
        const Error error = scene.error();
        if (!texts.drop(error)) return scene;
        faults.push_back(error);
    }
}

// Boxes stand for models that cannot be read or cooked. Settings that make no sense are left out.
Result<std::vector<Plant>> load_plants(const Document& document, const std::vector<SceneModel>& models,
                                       const Plant& box, const BaseSceneSettings& settings,
                                       std::vector<Error>& faults) {
    std::set<std::string> bad;
    std::map<std::string, std::vector<PartSettings>> parts_of;
    for (const SceneModel& model : models) {
        auto [parts, is_new] = parts_of.try_emplace(model.source_path);
        if (!is_new) continue;
        auto read = part_settings_in(document, model.source_path);
        if (read)
            parts->second = std::move(*read);
        else
            faults.push_back(read.error());
    }
    std::error_code ignored;
    for (const SceneModel& model : models)
        if (!bad.contains(model.source_path) && !std::filesystem::exists(model.source_path, ignored)) {
            faults.push_back({ErrorId::file_missing, model.source_path, "",
                              "no such file: '" + model.name + "' stands as boxes",
                              "bring it back, or give the population another source"});
            bad.insert(model.source_path);
        }
    while (true) {
        std::vector<PlantSource> sources;
        bool textured = false;
        for (const SceneModel& model : models) {
            if (bad.contains(model.source_path)) continue;
            sources.push_back({model.source_path, model.variation, parts_of[model.source_path]});
            textured |= !model.source_path.ends_with(".json") && !model.source_path.ends_with(".plant");
        }
        auto found = find_or_cook(settings.cache_dir, sources, CookSettings{}, settings.modeller,
                                  textured && settings.find_images ? settings.find_images() : nullptr);
        if (found) {
            std::vector<Plant> plants;
            size_t next = 0;
            for (const SceneModel& model : models)
                plants.push_back(bad.contains(model.source_path) ? box : std::move((*found)[next++]));
            return plants;
        }
        const bool known = std::any_of(sources.begin(), sources.end(), [&](const PlantSource& source) {
            return source.path == found.error().file;
        });
        if (!known) return fail(std::move(found.error()));
        faults.push_back(found.error());
        bad.insert(found.error().file);
    }
}

}  // namespace

Result<std::vector<PartSettings>> part_settings_in(const Document& document,
                                                   const std::string& plant_path) {
    const std::string path = part_settings_path(std::filesystem::path(plant_path).lexically_normal().string());
    const EcoFile* file = document.find(path);
    if (!file) return read_part_settings(plant_path);
    if (!file->text) return std::vector<PartSettings>();
    return parse_part_settings(file->text->text, path);
}

Result<BaseScene> make_base_scene(const Document& document, const BaseSceneSettings& settings) {
    BaseScene base;
    auto clock = std::chrono::steady_clock::now();
    Texts texts(document);
    COPPICE_TRY(base.scene, load_what_can_be(texts, document.root_path(), settings, base.faults));
    base.scene_ms = ms_since(clock);
    clock = std::chrono::steady_clock::now();
    COPPICE_TRY(Plant box, find_or_make_box(settings.cache_dir));
    COPPICE_TRY(base.plants, load_plants(document, base.scene.models, box, settings, base.faults));
    base.box.individuals = {{uint32_t(base.plants.size()), 1.0f}};
    base.scene.models.push_back({"missing plant", "", 0, 1.0f});
    base.plants.push_back(std::move(box));
    base.plants_ms = ms_since(clock);
    clock = std::chrono::steady_clock::now();
    std::vector<Box> bounds;
    for (const Plant& plant : base.plants) bounds.push_back(plant.bounds_plant);
    finish_tiles(base.scene, bounds);
    if (base.scene.terrain) shade_ground(base.scene, *base.scene.terrain, bounds);
    base.tiles_ms = ms_since(clock);
    return base;
}

uint64_t hash_base(const Document& document) {
    uint64_t hash = 0;
    for (const auto& [path, file] : document.files()) {
        if (!file.text) continue;
        hash = hash_text(path, hash);
        if (path == document.root_path()) {
            hash = hash_text(without_placed(file.text->json).dump(), hash);
            continue;
        }
        hash = hash_text(file.text->text, hash);
        for (const auto& [cell, plants] : file.plants.cells())
            for (const PlacedPlant& plant : plants) {
                hash = hash_combine(hash, uint64_t(uint32_t(plant.x)) << 32 | uint32_t(plant.z));
                hash = hash_combine(
                    hash, uint64_t(plant.turn) << 32 | uint64_t(plant.scale) << 16 | uint16_t(plant.lift));
                hash = hash_combine(hash, uint64_t(plant.kind) << 16 | plant.variation);
            }
    }
    return hash;
}

}  // namespace coppice
