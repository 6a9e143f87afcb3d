#include "plugins/vegetation/eco/read_scatter.h"

#include <fmt/format.h>
#include "plugins/shared/noise.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr float k_radians = k_pi / 180.0f;

void check_range(JsonObject& object, const char* key, float low, float high) {
    if (low > high)
        object.report(ErrorId::value_out_of_range, key, fmt::format("from {:g} down to {:g}", low, high),
                      "write the smaller number first");
}

void read_species(JsonObject& object, const SceneNames& names, ScatterSettings& s) {
    if (object.one_of({"plant", "plants"}) == 0) {
        if (const PlantKind* kind = names.find_kind(object, "plant", object.text("plant")))
            s.species.push_back({*kind, 1.0f});
        return;
    }
    JsonObject weights = object.object("plants");
    const nlohmann::json* list = object.find("plants");
    if (!object.document().sound()) return;
    for (const auto& [name, ignored] : list->items()) {
        float weight = weights.real(name.c_str(), 1e-6f, 1e6f);
        if (const PlantKind* kind = names.find_kind(weights, name.c_str(), name))
            s.species.push_back({*kind, weight});
    }
    if (list->empty()) object.report(ErrorId::syntax, "plants", "no plant", "write {\"name\": share, ...}");
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
    } else if (s.terrain) {
        Box bounds = s.terrain->bounds_local();
        dvec3 origin = s.terrain->origin_world();
        shape.center = dvec2(origin.x + double(bounds.center().x), origin.z + double(bounds.center().z));
        shape.half_size = dvec2(double(bounds.size().x), double(bounds.size().z)) * 0.5;
    } else {
        object.report(ErrorId::syntax, "region", "missing, and there is no terrain to cover",
                      "write a region; the terrain of a file that another refers to does not count");
    }
    Region region;
    region.shapes.push_back(std::move(shape));
    return region;
}

void read_heights(JsonObject& object, ScatterSettings& s) {
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

void read_noise(JsonObject noise, ScatterSettings& s) {
    s.noisy = true;
    s.noise.wavelength_m = noise.real("wavelength_m", 0.01f, 1e6f, s.noise.wavelength_m);
    s.noise.period_m = noise.number("period_m", 0.0, 1e6, 0.0);
    s.noise.from = noise.real("from", -2.0f, 3.0f, -2.0f);
    s.noise.to = noise.real("to", -2.0f, 3.0f, 3.0f);
    s.noise.softness = noise.real("softness", 0.0f, 1.0f, s.noise.softness);
    s.noise.octaves = uint32_t(noise.whole("octaves", 1, 12, s.noise.octaves));
    s.noise.seed = uint32_t(noise.whole("seed", 0, UINT32_MAX, 1));
    check_range(noise, "from", s.noise.from, s.noise.to);
    if (s.noise.period_m > 0.0 && !(s.noise.period_m >= double(s.noise.wavelength_m)))
        noise.report(ErrorId::value_out_of_range, "period_m", "shorter than a wave", "at least wavelength_m");
    if (std::ldexp(s.noise.period_m / double(s.noise.wavelength_m), int(s.noise.octaves)) >
        k_longest_noise_period)
        noise.report(ErrorId::value_out_of_range, "period_m", "too many of the last octave's waves",
                     "fewer octaves or a longer wavelength_m");
    noise.close();
}

}  // namespace

const PlantKind* SceneNames::find_kind(JsonObject& object, const char* key, const std::string& name) const {
    if (auto found = kinds.find(name); found != kinds.end()) return &found->second;
    std::vector<std::string> known;
    for (const auto& [kind, ignored] : kinds) known.push_back(kind);
    object.report(ErrorId::name_unknown, key, fmt::format("unknown plant '{}'", name),
                  known_names(name, std::move(known)));
    return nullptr;
}

void read_scale_range(JsonObject& object, float& low, float& high) {
    auto range = object.numbers("scale", 2, double(k_scale_least), double(k_scale_most),
                                std::vector<double>{1.0, 1.0});
    low = float(range[0]);
    high = float(range[1]);
    check_range(object, "scale", low, high);
}

ScatterSettings read_scatter(JsonObject& object, const SceneNames& names, const Terrain* terrain) {
    ScatterSettings s;
    s.terrain = terrain;
    JsonDocument& document = object.document();
    read_species(object, names, s);
    if (!document.sound()) return s;
    if (const nlohmann::json* region = object.find("region"))
        s.region = read_region(document, *region, object.place_of("region"), names.regions);
    if (const nlohmann::json* exclude = object.find("exclude"))
        s.exclude = read_region(document, *exclude, object.place_of("exclude"), names.regions);
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
    read_scale_range(object, s.scale_low, s.scale_high);
    if (object.has("height_m")) read_heights(object, s);
    s.lean_most_rad = object.real("tilt_deg", 0.0f, 90.0f, 0.0f) * k_radians;
    s.rule.align_to_ground = object.real("align_to_ground", 0.0f, 1.0f, 0.0f);
    s.rule.slope_most_rad = object.has("slope_max_deg")
                                ? object.real("slope_max_deg", 0.0f, 90.0f) * k_radians
                                : s.rule.slope_most_rad;
    if (object.has("altitude_m")) {
        auto range = object.numbers("altitude_m", 2, -1e5, 1e5);
        s.rule.altitude_low_m = float(range[0]);
        s.rule.altitude_high_m = float(range[1]);
        check_range(object, "altitude_m", s.rule.altitude_low_m, s.rule.altitude_high_m);
    }
    if (object.has("density_noise")) read_noise(object.object("density_noise"), s);
    // Two scatters written alike must not put their plants on the same spots.
    s.seed = object.whole("seed", 0, UINT64_MAX, hash_text(object.place_of("seed")));
    object.close();
    return s;
}

}  // namespace coppice
