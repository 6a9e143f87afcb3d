#include "plugins/vegetation/eco/load_scene.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <fmt/format.h>
#include "plugins/vegetation/eco/camera_path.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/read_placements_csv.h"
#include "plugins/vegetation/eco/scatter.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr float k_radians = k_pi / 180.0f;
constexpr float k_scale_least = 1e-3f, k_scale_most = 1e3f;
constexpr uint64_t k_variation_limit = 1024, k_model_limit = 65536;

class SceneReader {
  public:
    SceneReader(JsonDocument& document, const std::string& path, const SceneLoadSettings& settings)
        : document_(document), root_(document, document.root(), ""), settings_(settings) {
        scene_.path = path;
        folder_ = std::filesystem::path(path).parent_path();
    }

    Result<Scene> read() {
        scene_.name = root_.text("name", std::filesystem::path(scene_.path).stem().stem().string());
        scene_.sample_distance_px = root_.real("sample_distance_px", 0.01f, 1000.0f, 1.0f);
        read_plants(root_.object("plants"));
        read_regions();
        read_light();
        const nlohmann::json* terrain = root_.find("terrain");
        std::vector<JsonObject> placements = root_.objects("placements");
        const nlohmann::json* camera_path = root_.find("camera_path");
        root_.close();
        COPPICE_CHECK(document_.status());
        if (terrain) COPPICE_CHECK(load_terrain(*terrain));
        for (JsonObject& entry : placements) COPPICE_CHECK(read_placement(entry));
        COPPICE_CHECK(read_camera_path(camera_path));
        make_tiles(plants_, scene_);
        return std::move(scene_);
    }

  private:
    std::string resolve(const std::string& name) const {
        return (folder_ / name).lexically_normal().string();
    }

    void read_plants(JsonObject object) {
        const nlohmann::json* plants = root_.find("plants");
        if (!plants || !plants->is_object()) return;
        for (const auto& [name, ignored] : plants->items()) {
            JsonObject entry = object.object(name.c_str());
            PlantKind kind;
            kind.first_model = uint32_t(scene_.models.size());
            std::string source = entry.text("source");
            kind.variation_count = uint32_t(entry.whole("variations", 1, k_variation_limit, 1));
            kind.height_m = entry.real("height_m", 0.001f, 1000.0f, 0.0f);
            float importance = entry.real("importance", 0.001f, 1000.0f, 1.0f);
            entry.close();
            if (kind.variation_count > 1 && !source.ends_with(".json"))
                entry.report(ErrorId::value_out_of_range, "variations", "a model file has one shape",
                             "variations of a species file, or leave it out");
            if (scene_.models.size() + kind.variation_count > k_model_limit)
                entry.report(ErrorId::limit_exceeded, "variations", "too many models",
                             fmt::format("at most {} in all", k_model_limit));
            if (!document_.sound()) return;
            for (uint32_t v = 0; v < kind.variation_count; ++v)
                scene_.models.push_back({name, resolve(source), v, importance});
            kinds_[name] = kind;
            names_.push_back(name);
        }
    }

    void read_regions() {
        const nlohmann::json* regions = root_.find("regions");
        if (!regions) return;
        JsonObject object = root_.object("regions");
        if (!document_.sound()) return;
        // Names refer to shapes only, never to each other: nothing can be circular.
        for (const auto& [name, value] : regions->items())
            named_[name] = read_region(document_, value, object.place_of(name.c_str()));
    }

    void read_light() {
        Light& light = scene_.light;
        if (const nlohmann::json* sun = root_.find("sun"); sun && sun->is_null()) {
            light.direction_to_sun = vec3(0.0f);
        } else if (sun) {
            JsonObject object = root_.object("sun");
            float azimuth = object.real("azimuth_deg", -360.0f, 360.0f, 137.0f) * k_radians;
            float elevation = object.real("elevation_deg", -90.0f, 90.0f, 49.0f) * k_radians;
            light.direction_to_sun =
                vec3(portable_sin(azimuth) * portable_cos(elevation), portable_sin(elevation),
                     -portable_cos(azimuth) * portable_cos(elevation));
            light.sun_color = object.color("color", 100.0f, light.sun_color);
            object.close();
        }
        if (root_.has("sky")) {
            JsonObject object = root_.object("sky");
            light.sky_zenith_color = object.color("zenith", 100.0f, light.sky_zenith_color);
            light.sky_horizon_color = object.color("horizon", 100.0f, light.sky_horizon_color);
            light.ground_color = object.color("ground", 100.0f, light.ground_color);
            object.close();
        }
        if (root_.has("haze")) {
            JsonObject object = root_.object("haze");
            light.haze_color = object.color("color", 100.0f, light.haze_color);
            light.haze_density_per_m = object.real("density_per_m", 0.0f, 10.0f, light.haze_density_per_m);
            object.close();
        }
        light.exposure = root_.real("exposure", 0.001f, 1000.0f, 1.0f);
    }

    Status load_terrain(const nlohmann::json& terrain) {
        if (!settings_.terrain)
            return fail(ErrorId::name_unknown, scene_.path, "terrain", "the terrain plugin is not loaded",
                        "install it, or take \"terrain\" out of the scene");
        COPPICE_TRY(scene_.terrain, settings_.terrain->load(terrain.dump(), folder_.string(), scene_.path));
        return {};
    }

    const PlantKind* find_kind(JsonObject& object, const char* key, const std::string& name) {
        if (auto found = kinds_.find(name); found != kinds_.end()) return &found->second;
        object.report(ErrorId::name_unknown, key, fmt::format("unknown plant '{}'", name),
                      known_names(name, names_));
        return nullptr;
    }

    Status add(const std::vector<Placement>& more, const std::string& place) {
        if (plants_.size() + more.size() > k_plant_limit)
            return fail(ErrorId::limit_exceeded, scene_.path, place,
                        fmt::format("{} plants with those before", plants_.size() + more.size()),
                        fmt::format("at most {} in a scene", k_plant_limit));
        if (plants_.empty())
            plants_ = more;
        else
            plants_.insert(plants_.end(), more.begin(), more.end());
        return {};
    }

    Status read_placement(JsonObject& entry) {
        size_t kind = entry.one_of({"plant", "csv", "scatter"});
        COPPICE_CHECK(document_.status());
        if (kind == 0) return read_single(entry);
        if (kind == 1) return read_csv(entry);
        JsonObject object = entry.object("scatter");
        entry.close();
        ScatterSettings settings = read_scatter(object);
        COPPICE_CHECK(document_.status());
        COPPICE_TRY(std::vector<Placement> plants, scatter(settings, scene_.path, entry.place_of("scatter")));
        return add(plants, entry.place_of("scatter"));
    }

    Status read_single(JsonObject& entry) {
        const PlantKind* kind = find_kind(entry, "plant", entry.text("plant"));
        Placement plant;
        const nlohmann::json* at = entry.find("at");
        if (at && at->is_array() && at->size() == 2) {
            auto xz = entry.numbers("at", 2, -k_farthest_m, k_farthest_m);
            plant.position_world = dvec3(xz[0], ground_height(scene_.terrain.get(), xz[0], xz[1]), xz[1]);
        } else {
            auto xyz = entry.numbers("at", 3, -k_farthest_m, k_farthest_m);
            plant.position_world = dvec3(xyz[0], xyz[1], xyz[2]);
        }
        Random random(hash_text("placement"), plants_.size());
        float turn = entry.real("turn_deg", -360.0f, 360.0f, random.next_unit() * 360.0f) * k_radians;
        float tilt = entry.real("tilt_deg", 0.0f, 180.0f, 0.0f) * k_radians;
        float bearing = entry.real("tilt_towards_deg", -360.0f, 360.0f, 0.0f) * k_radians;
        plant.turn = make_turn(turn, tilt, vec3(portable_sin(bearing), 0.0f, -portable_cos(bearing)));
        plant.scale = entry.real("scale", k_scale_least, k_scale_most, 1.0f);
        uint32_t variations = kind ? kind->variation_count : 1;
        uint64_t variation = entry.whole("variation", 0, variations - 1, random.next_below(variations));
        entry.close();
        COPPICE_CHECK(document_.status());
        plant.model = {kind->first_model + uint32_t(variation), uint32_t(random.next_bits() >> 32)};
        return add({plant}, entry.place_of("plant"));
    }

    void read_scale(JsonObject& object, float& low, float& high) {
        auto range = object.numbers("scale", 2, double(k_scale_least), double(k_scale_most),
                                    std::vector<double>{1.0, 1.0});
        low = float(range[0]);
        high = float(range[1]);
        check_range(object, "scale", low, high);
    }

    void check_range(JsonObject& object, const char* key, float low, float high) {
        if (low > high)
            object.report(ErrorId::value_out_of_range, key, fmt::format("from {:g} down to {:g}", low, high),
                          "write the smaller number first");
    }

    Status read_csv(JsonObject& entry) {
        CsvSettings settings;
        std::string name = entry.text("csv");
        auto offset = entry.numbers("offset", 2, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                    std::vector<double>{0.0, 0.0});
        settings.offset = dvec2(offset[0], offset[1]);
        read_scale(entry, settings.scale_low, settings.scale_high);
        settings.seed = entry.whole("seed", 0, UINT64_MAX, 1);
        settings.kinds = kinds_;
        settings.terrain = scene_.terrain.get();
        if (const nlohmann::json* species = entry.find("species")) {
            JsonObject map = entry.object("species");  // {"name in the file": "plant"}
            if (!document_.sound()) return document_.status();
            for (const auto& [alias, ignored] : species->items())
                if (const PlantKind* kind = find_kind(map, alias.c_str(), map.text(alias.c_str())))
                    settings.kinds[alias] = *kind;
        }
        entry.close();
        COPPICE_CHECK(document_.status());
        COPPICE_TRY(std::vector<Placement> plants, read_placements_csv(resolve(name), settings));
        return add(plants, entry.place_of("csv"));
    }

    ScatterSettings read_scatter(JsonObject& object) {
        ScatterSettings s;
        if (object.one_of({"plant", "plants"}) == 0) {
            if (const PlantKind* kind = find_kind(object, "plant", object.text("plant")))
                s.species.push_back({*kind, 1.0f});
        } else {
            JsonObject weights = object.object("plants");
            const nlohmann::json* list = object.find("plants");
            if (!document_.sound()) return s;
            for (const auto& [name, ignored] : list->items()) {
                float weight = weights.real(name.c_str(), 1e-6f, 1e6f);
                if (const PlantKind* kind = find_kind(weights, name.c_str(), name))
                    s.species.push_back({*kind, weight});
            }
            if (list->empty())
                object.report(ErrorId::syntax, "plants", "no plant", "write {\"name\": share, ...}");
        }
        s.terrain = scene_.terrain.get();
        if (const nlohmann::json* region = object.find("region"))
            s.region = read_region(document_, *region, object.place_of("region"), named_);
        if (const nlohmann::json* exclude = object.find("exclude"))
            s.exclude = read_region(document_, *exclude, object.place_of("exclude"), named_);
        s.edge_m = object.real("edge_m", 0.0f, 1e5f, 0.0f);
        switch (object.one_of({"density_per_m2", "count", "grid"})) {
            case 0:
                s.density_per_m2 = object.number("density_per_m2", 1e-9, 1e5);
                break;
            case 1:
                s.count = object.whole("count", 1, k_plant_limit);
                break;
            case 2:
                read_grid(object.object("grid"), s);
                break;
        }
        if (s.region.shapes.empty()) s.region = whole_ground(object, s);
        s.spacing_m = object.number("spacing_m", 0.0, 1e4, 0.0);
        if (s.grid_spacing_m > 0.0 && s.spacing_m > 0.0)
            object.report(ErrorId::syntax, "spacing_m", "a grid has its own spacing", "leave it out");
        read_scale(object, s.scale_low, s.scale_high);
        if (object.has("height_m")) {
            auto range = object.numbers("height_m", 2, 0.001, 1000.0);
            s.height_low_m = float(range[0]);
            s.height_high_m = float(range[1]);
            check_range(object, "height_m", s.height_low_m, s.height_high_m);
            if (object.has("scale"))
                object.report(ErrorId::syntax, "height_m", "both scale and height_m", "write one of them");
            for (const ScatterSpecies& species : s.species)
                if (!(species.kind.height_m > 0.0f))
                    object.report(ErrorId::value_out_of_range, "height_m",
                                  "the height of a plant's model is not known",
                                  "give \"height_m\" of each of these plants under \"plants\" of the scene");
        }
        s.lean_most_rad = object.real("tilt_deg", 0.0f, 90.0f, 0.0f) * k_radians;
        s.align_to_ground = object.real("align_to_ground", 0.0f, 1.0f, 0.0f);
        s.slope_most_rad = object.real("slope_max_deg", 0.0f, 90.0f, 90.0f) * k_radians;
        if (object.has("altitude_m")) {
            auto range = object.numbers("altitude_m", 2, -1e5, 1e5);
            s.altitude_low_m = float(range[0]);
            s.altitude_high_m = float(range[1]);
            check_range(object, "altitude_m", s.altitude_low_m, s.altitude_high_m);
        }
        if (object.has("density_noise")) {
            s.noisy = true;
            JsonObject noise = object.object("density_noise");
            s.noise.wavelength_m = noise.real("wavelength_m", 0.01f, 1e6f, s.noise.wavelength_m);
            s.noise.from = noise.real("from", -2.0f, 3.0f, -2.0f);
            s.noise.to = noise.real("to", -2.0f, 3.0f, 3.0f);
            s.noise.softness = noise.real("softness", 0.0f, 1.0f, s.noise.softness);
            s.noise.octaves = uint32_t(noise.whole("octaves", 1, 12, s.noise.octaves));
            s.noise.seed = uint32_t(noise.whole("seed", 0, UINT32_MAX, 1));
            check_range(noise, "from", s.noise.from, s.noise.to);
            noise.close();
        }
        // Two scatters written alike must not put their plants on the same spots.
        s.seed = object.whole("seed", 0, UINT64_MAX, hash_text(object.place_of("seed")));
        object.close();
        return s;
    }

    void read_grid(JsonObject grid, ScatterSettings& s) {
        s.grid_spacing_m = grid.number("spacing_m", 0.001, 1e5);
        s.grid_jitter_m = grid.number("jitter_m", 0.0, 1e5, 0.0);
        s.grid_columns = uint32_t(grid.whole("columns", 1, k_plant_limit, 0));
        s.grid_rows = uint32_t(grid.whole("rows", 1, k_plant_limit, 0));
        grid.close();
    }

    // Without a region plants stand all over the terrain, or over the grid they ask for.
    Region whole_ground(JsonObject& object, const ScatterSettings& s) {
        RegionShape shape;
        shape.kind = RegionShape::Kind::rectangle;
        if (s.grid_columns && s.grid_rows) {
            shape.half_size =
                dvec2(s.grid_columns, s.grid_rows) * (0.5 * s.grid_spacing_m) + s.grid_jitter_m + 1.0;
        } else if (scene_.terrain) {
            Box bounds = scene_.terrain->bounds_local();
            dvec3 origin = scene_.terrain->origin_world();
            shape.center = dvec2(origin.x + double(bounds.center().x), origin.z + double(bounds.center().z));
            shape.half_size = dvec2(double(bounds.size().x), double(bounds.size().z)) * 0.5;
        } else {
            object.report(ErrorId::syntax, "region", "missing, and there is no terrain to cover",
                          "write a region");
        }
        Region region;
        region.shapes.push_back(std::move(shape));
        return region;
    }

    Status read_camera_path(const nlohmann::json* value) {
        if (value && value->is_string()) {
            COPPICE_TRY(scene_.camera_path,
                        load_camera_path(resolve(value->get<std::string>()), scene_.terrain.get()));
            return {};
        }
        if (value) scene_.camera_path = read_camera_keys(root_.objects("camera_path"), scene_.terrain.get());
        if (scene_.camera_path.empty()) {
            Camera camera;
            camera.position_world.y += ground_height(scene_.terrain.get(), 0.0, 0.0);
            scene_.camera_path.push_back({0.0, camera});
        }
        return document_.status();
    }

    JsonDocument& document_;
    JsonObject root_;
    const SceneLoadSettings& settings_;
    std::filesystem::path folder_;
    Scene scene_;
    std::map<std::string, PlantKind> kinds_;
    std::vector<std::string> names_;
    NamedRegions named_;
    std::vector<Placement> plants_;
};

}  // namespace

Result<Scene> load_scene(const std::string& path, const SceneLoadSettings& settings) {
    COPPICE_TRY(std::string text, read_text_file(path));
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(text, path));
    return SceneReader(document, path, settings).read();
}

}  // namespace coppice
