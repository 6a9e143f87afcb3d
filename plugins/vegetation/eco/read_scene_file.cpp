#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <fmt/format.h>
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/measure_population.h"
#include "plugins/vegetation/eco/place_named.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "plugins/vegetation/eco/quantise.h"
#include "plugins/vegetation/eco/read_light.h"
#include "plugins/vegetation/eco/read_placements_csv.h"
#include "plugins/vegetation/eco/read_references.h"
#include "plugins/vegetation/eco/read_scatter.h"
#include "plugins/vegetation/eco/scene_file.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr float k_radians = k_pi / 180.0f;

constexpr const char* k_placement_kinds[] = {"plant", "csv", "scatter", "packed", "gltf"};
enum : size_t { k_single, k_csv, k_scatter, k_packed, k_gltf };

struct Population {
    std::string name;
    uint32_t individual_count, first_model, model_count;
};

class SceneReader {
  public:
    SceneReader(JsonDocument& document, const std::string& path, const SceneLoadSettings& settings,
                SceneRole role)
        : document_(document),
          root_(document, document.root(), ""),
          settings_(settings),
          role_(role),
          pictures_(settings.find_images) {
        scene_.path = path;
        folder_ = std::filesystem::path(path).parent_path();
        names_.read_map = [this](const std::string& name, MapChannel channel) {
            return pictures_.read(resolve(name), channel);
        };
        names_.places_of = [this](const std::string& kind) { return places_of(kind); };
    }

    Result<SceneFile> read() {
        if (root_.has("mosaic"))
            return fail(ErrorId::limit_exceeded, scene_.path, "mosaic",
                        role_ == SceneRole::root ? "a mosaic of scenes is never loaded as a whole"
                                                 : "a mosaic of scenes cannot be referred to",
                        role_ == SceneRole::root
                            ? "populate it: coppice populate SCENE -o DIR, then coppice play DIR"
                            : "refer to its scenes, or make a mosaic of both");
        scene_.name = root_.text("name", std::filesystem::path(scene_.path).stem().stem().string());
        scene_.sample_distance_px = root_.real("sample_distance_px", 0.01f, 1000.0f, 1.0f);
        // A scene may consist of other scenes alone.
        const bool refers = root_.has("references");
        if (!refers || root_.has("plants")) read_plants(root_.object("plants"));
        read_regions();
        scene_.light = read_light(root_);
        const nlohmann::json* terrain = root_.find("terrain");
        if (!refers || root_.has("placements")) placements_ = root_.objects("placements");
        if (refers) file_.references = read_references(root_.objects("references"), folder_);
        root_.has("camera_path");
        root_.close();
        COPPICE_CHECK(document_.status());
        COPPICE_CHECK(quantise_plants());
        if (role_ == SceneRole::referenced)
            note_what_is_left_out();
        else if (terrain)
            COPPICE_CHECK(load_terrain(*terrain));
        for (; next_placement_ < placements_.size(); ++next_placement_)
            COPPICE_CHECK(read_placement(placements_[next_placement_]));
        if (role_ == SceneRole::root) {
            COPPICE_TRY(scene_.camera_path,
                        read_camera_path(root_, folder_, height_of(scene_.terrain.get())));
        }
        scene_.kinds = std::move(names_.kinds);
        return std::move(file_);
    }

  private:
    void note_what_is_left_out() {
        std::string keys;
        for (const char* key :
             {"terrain", "sun", "sky", "haze", "exposure", "camera_path", "sample_distance_px"})
            if (root_.has(key)) keys += (keys.empty() ? "" : ", ") + std::string(key);
        if (!keys.empty()) log_note("{}: {} left out, because another scene refers to it", scene_.path, keys);
    }

    std::string resolve(const std::string& name) const {
        return (folder_ / name).lexically_normal().string();
    }

    void read_plants(JsonObject object) {
        const nlohmann::json* plants = root_.find("plants");
        if (!plants || !plants->is_object()) return;
        for (const auto& [name, ignored] : plants->items()) {
            JsonObject entry = object.object(name.c_str());
            PlantKind kind;
            const uint32_t first_model = uint32_t(scene_.models.size());
            std::string source = entry.text("source");
            const uint64_t variations = entry.whole("variations", 1, k_individual_limit, 1);
            const uint64_t individuals =
                entry.whole("individuals", variations, k_individual_limit, variations);
            kind.height_m = entry.real("height_m", 0.001f, 1000.0f, 0.0f);
            float importance = entry.real("importance", 0.001f, 1000.0f, 1.0f);
            ColorVariation color;
            if (entry.has("color_variation")) {
                JsonObject object = entry.object("color_variation");
                color = read_color_variation(object);
            }
            entry.close();
            if (individuals > 1 && !source.ends_with(".json"))
                entry.report(ErrorId::value_out_of_range, variations > 1 ? "variations" : "individuals",
                             "a model file has one shape", "a species file, or leave it out");
            if (scene_.models.size() + variations > k_model_limit)
                entry.report(ErrorId::limit_exceeded, "variations", "too many models",
                             fmt::format("at most {} in all", k_model_limit));
            if (!document_.sound()) return;
            kind.individuals.clear();
            for (uint32_t v = 0; v < variations; ++v) {
                scene_.models.push_back({name, resolve(source), v, importance, color});
                kind.individuals.push_back({first_model + v, 1.0f});
            }
            if (individuals > variations)
                populations_.push_back({name, uint32_t(individuals), first_model, uint32_t(variations)});
            names_.kinds[name] = std::move(kind);
        }
    }

    // Which of a population's individuals become its models, and what each of the others is drawn as.
    Status quantise_plants() {
        for (const Population& p : populations_) {
            const std::span<SceneModel> models =
                std::span(scene_.models).subspan(p.first_model, p.model_count);
            COPPICE_TRY(const std::vector<PlantFeatures> features,
                        measure_population({models.front().source_path, p.individual_count},
                                           settings_.modeller, settings_.cache_dir));
            const Quantised quantised = quantise(features, p.model_count);
            for (uint32_t m = 0; m < p.model_count; ++m) models[m].variation = quantised.medoids[m];
            std::vector<PlantIndividual>& individuals = names_.kinds.at(p.name).individuals;
            individuals.clear();
            for (uint32_t i = 0; i < p.individual_count; ++i)
                individuals.push_back({p.first_model + quantised.medoid_of[i], quantised.scale_of[i]});
            const auto [least, most] = std::ranges::minmax(quantised.scale_of);
            log_note(
                "{}: {}: {} individuals drawn as {} of them, scaled by {:.2f} to {:.2f}; error {:.2f} "
                "spreads",
                scene_.path, p.name, p.individual_count, p.model_count, least, most,
                quantised.error_by_count.back());
        }
        return {};
    }

    void read_regions() {
        const nlohmann::json* regions = root_.find("regions");
        if (!regions) return;
        JsonObject object = root_.object("regions");
        if (!document_.sound()) return;
        // Names refer to shapes only, never to each other: nothing can be circular.
        for (const auto& [name, value] : regions->items())
            names_.regions[name] = read_region(document_, value, object.place_of(name.c_str()));
    }

    Status load_terrain(const nlohmann::json& terrain) {
        if (!settings_.terrain)
            return fail(ErrorId::name_unknown, scene_.path, "terrain", "the terrain plugin is not loaded",
                        "install it, or take \"terrain\" out of the scene");
        COPPICE_TRY(scene_.terrain, settings_.terrain->load(terrain.dump(), folder_.string(), scene_.path));
        return {};
    }

    Status add(std::vector<Placement> more, const std::string& place, const GroundRule& rule = {}) {
        plant_count_ += more.size();
        if (plant_count_ > k_plant_limit)
            return fail(ErrorId::limit_exceeded, scene_.path, place,
                        fmt::format("{} plants with those before", plant_count_),
                        fmt::format("at most {} in a scene", k_plant_limit));
        std::vector<PlantGroup>& groups = file_.groups;
        if (groups.empty() || groups.back().rule != rule)
            groups.push_back({std::move(more), rule});
        else
            groups.back().plants.insert(groups.back().plants.end(), more.begin(), more.end());
        return {};
    }

    Status read_placement(JsonObject& entry) {
        const size_t kind = placement_kind(entry);
        COPPICE_CHECK(document_.status());
        if (kind != k_scatter) {
            COPPICE_TRY(std::vector<Placement> plants, read_fixed(entry, kind));
            return add(std::move(plants), entry.place_of(k_placement_kinds[kind]));
        }
        JsonObject object = entry.object("scatter");
        entry.close();
        ScatterSettings settings = read_scatter(object, names_, scene_.terrain.get());
        COPPICE_CHECK(document_.status());
        GroundRule rule;
        if (role_ == SceneRole::referenced) std::swap(rule, settings.rule);
        COPPICE_TRY(std::vector<Placement> plants, scatter(settings, scene_.path, entry.place_of("scatter")));
        return add(std::move(plants), entry.place_of("scatter"), rule);
    }

    static size_t placement_kind(JsonObject& entry) {
        return entry.one_of({k_placement_kinds[0], k_placement_kinds[1], k_placement_kinds[2], k_placement_kinds[3],
                             k_placement_kinds[4]});
    }

    Result<std::vector<Placement>> read_fixed(JsonObject& entry, size_t kind) {
        if (kind == k_single) return read_single(entry);
        if (kind == k_csv) return read_csv(entry);
        if (kind == k_gltf) return read_gltf(entry);
        return read_packed(entry);
    }

    // Of what stands before the scatter that is read; and all that is no scatter, wherever it is written, so that what is
    // planted one by one counts for every rule.
    Result<std::vector<dvec2>> places_of(const std::string& kind) {
        std::vector<dvec2> places;
        auto keep = [&](const std::vector<Placement>& plants) {
            for (const Placement& plant : plants)
                if (scene_.models[plant.model.model].name == kind)
                    places.emplace_back(plant.position_world.x, plant.position_world.z);
        };
        for (const PlantGroup& group : file_.groups) keep(group.plants);
        for (size_t later = next_placement_ + 1; later < placements_.size(); ++later) {
            const size_t of = placement_kind(placements_[later]);
            COPPICE_CHECK(document_.status());
            if (of == k_scatter) continue;
            // One that cannot be read is reported when its turn comes.
            const auto [fixed, is_new] = fixed_.try_emplace(later);
            if (is_new)
                if (auto plants = read_fixed(placements_[later], of)) fixed->second = std::move(*plants);
            keep(fixed->second);
            COPPICE_CHECK(document_.status());
        }
        return places;
    }

    Result<std::vector<Placement>> read_single(JsonObject& entry) {
        const PlantKind* kind = names_.find_kind(entry, "plant", entry.text("plant"));
        Placement plant;
        const nlohmann::json* at = entry.find("at");
        if (at && at->is_array() && at->size() == 2) {
            auto xz = entry.numbers("at", 2, -k_farthest_m, k_farthest_m);
            plant.position_world = dvec3(xz[0], ground_height(scene_.terrain.get(), xz[0], xz[1]), xz[1]);
        } else {
            auto xyz = entry.numbers("at", 3, -k_farthest_m, k_farthest_m);
            plant.position_world = dvec3(xyz[0], xyz[1], xyz[2]);
        }
        Random random(hash_text("placement"), plant_count_);
        float turn = entry.real("turn_deg", -360.0f, 360.0f, random.next_unit() * 360.0f) * k_radians;
        float tilt = entry.real("tilt_deg", 0.0f, 180.0f, 0.0f) * k_radians;
        float bearing = entry.real("tilt_towards_deg", -360.0f, 360.0f, 0.0f) * k_radians;
        plant.turn = make_turn(turn, tilt, vec3(portable_sin(bearing), 0.0f, -portable_cos(bearing)));
        plant.scale = entry.real("scale", k_scale_least, k_scale_most, 1.0f);
        uint32_t count = kind ? uint32_t(kind->individuals.size()) : 1;
        uint64_t variation = entry.whole("variation", 0, count - 1, random.next_below(count));
        entry.close();
        COPPICE_CHECK(document_.status());
        const PlantIndividual& individual = kind->individuals[variation];
        plant.model = {individual.model, uint32_t(random.next_bits() >> 32)};
        plant.scale *= individual.scale;
        return std::vector{plant};
    }

    Result<std::vector<Placement>> read_csv(JsonObject& entry) {
        CsvSettings settings;
        std::string name = entry.text("csv");
        auto offset = entry.numbers("offset", 2, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                    std::vector<double>{0.0, 0.0});
        settings.offset = dvec2(offset[0], offset[1]);
        read_scale_range(entry, settings.scale_low, settings.scale_high);
        settings.seed = entry.whole("seed", 0, UINT64_MAX, 1);
        settings.kinds = read_species(entry);
        settings.terrain = scene_.terrain.get();
        entry.close();
        COPPICE_CHECK(document_.status());
        return read_placements_csv(resolve(name), settings);
    }

    // {"name in the file": "plant"}, beside the plants' own names.
    std::map<std::string, PlantKind> read_species(JsonObject& entry) {
        std::map<std::string, PlantKind> kinds = names_.kinds;
        const nlohmann::json* species = entry.find("species");
        if (!species) return kinds;
        JsonObject map = entry.object("species");
        if (!document_.sound()) return kinds;
        for (const auto& [alias, ignored] : species->items())
            if (const PlantKind* kind = names_.find_kind(map, alias.c_str(), map.text(alias.c_str())))
                kinds[alias] = *kind;
        return kinds;
    }

    Result<std::vector<Placement>> read_gltf(JsonObject& entry) {
        const std::string path = resolve(entry.text("gltf"));
        const auto offset = entry.numbers("offset", 3, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                          std::vector<double>{0.0, 0.0, 0.0});
        PlaceNamedSettings settings{read_species(entry), dvec3(offset[0], offset[1], offset[2]),
                                    entry.whole("seed", 0, UINT64_MAX, 1)};
        entry.close();
        COPPICE_CHECK(document_.status());
        if (!settings_.read_gltf)
            return fail(ErrorId::format_unknown, scene_.path, entry.place_of("gltf"), "glTF files are not read here",
                        "place these plants by a table or one by one");
        COPPICE_TRY(const std::vector<NamedPlaces> named, settings_.read_gltf(path));
        return place_named(named, settings, path);
    }

    // On the ground, wherever that has come to lie since they were placed.
    Result<std::vector<Placement>> read_packed(JsonObject& entry) {
        const std::string path = resolve(entry.text("packed"));
        entry.close();
        COPPICE_CHECK(document_.status());
        COPPICE_TRY(const std::string bytes, read_scene_bytes(path, settings_));
        COPPICE_TRY(const PlacedPlants placed, read_placed(bytes, path));
        std::vector<const PlantKind*> kinds;
        for (const std::string& name : placed.kinds) kinds.push_back(names_.find_kind(entry, "packed", name));
        COPPICE_CHECK(document_.status());
        std::vector<Placement> plants(placed.plants.size());
        const Terrain* terrain = scene_.terrain.get();
        parallel_for(plants.size(), 4096, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                const dvec2 at = ground_place(placed.plants[i]);
                plants[i] = unpack_placed(placed.plants[i], *kinds[placed.plants[i].kind],
                                          ground_height(terrain, at.x, at.y));
            }
        });
        return plants;
    }

    JsonDocument& document_;
    JsonObject root_;
    const SceneLoadSettings& settings_;
    SceneRole role_;
    std::filesystem::path folder_;
    SceneFile file_;
    Scene& scene_ = file_.scene;
    SceneNames names_;
    MapPictures pictures_;
    std::vector<Population> populations_;
    std::vector<JsonObject> placements_;
    size_t next_placement_ = 0;  // the one that is read
    std::map<size_t, std::vector<Placement>> fixed_;  // those behind it that rules asked for
    uint64_t plant_count_ = 0;
};

}  // namespace

Result<std::string> read_scene_bytes(const std::string& path, const SceneLoadSettings& settings) {
    return settings.read_file ? settings.read_file(path) : read_text_file(path, k_scene_file_limit_bytes);
}

Result<SceneFile> read_scene_file(const std::string& path, const SceneLoadSettings& settings,
                                  SceneRole role) {
    COPPICE_TRY(std::string text, read_scene_bytes(path, settings));
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(text, path));
    return SceneReader(document, path, settings, role).read();
}

}  // namespace coppice
