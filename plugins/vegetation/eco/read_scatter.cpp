#include "plugins/vegetation/eco/read_scatter.h"

#include <algorithm>
#include <fmt/format.h>
#include "plugins/shared/noise.h"
#include "plugins/vegetation/eco/compete.h"
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

RegionShape rectangle_of(const Terrain& terrain) {
    RegionShape shape;
    shape.kind = RegionShape::Kind::rectangle;
    const Box bounds = terrain.bounds_local();
    const dvec3 origin = terrain.origin_world();
    shape.center = dvec2(origin.x + double(bounds.center().x), origin.z + double(bounds.center().z));
    shape.half_size = dvec2(double(bounds.size().x), double(bounds.size().z)) * 0.5;
    return shape;
}

// Without a region plants stand all over the terrain, or over the grid they ask for.
Region whole_ground(JsonObject& object, const ScatterSettings& s) {
    RegionShape shape;
    shape.kind = RegionShape::Kind::rectangle;
    if (s.grid_columns && s.grid_rows) {
        shape.half_size =
            dvec2(s.grid_columns, s.grid_rows) * (0.5 * s.grid_spacing_m) + s.grid_jitter_m + 1.0;
    } else if (s.terrain) {
        shape = rectangle_of(*s.terrain);
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

// Without a rectangle the map lies over all the terrain.
void read_map(JsonObject map, const SceneNames& names, ScatterSettings& s) {
    DensityMap read;
    const std::string name = map.text("picture");
    const std::string channel = map.text("channel", "mean");
    const std::vector<std::string> channels{"mean", "red", "green", "blue"};
    const size_t which = size_t(std::find(channels.begin(), channels.end(), channel) - channels.begin());
    if (which == channels.size())
        map.report(ErrorId::name_unknown, "channel", "unknown channel '" + channel + "'",
                   known_names(channel, channels));
    if (s.terrain && !map.has("size_m") && !map.has("center")) {
        const RegionShape ground = rectangle_of(*s.terrain);
        read.low = ground.center - ground.half_size;
        read.size_m = ground.half_size * 2.0;
    } else {
        const auto center = map.numbers("center", 2, -k_farthest_m, k_farthest_m);
        const auto size = map.numbers("size_m", 2, 0.01, 2.0 * k_farthest_m);
        read.size_m = dvec2(size[0], size[1]);
        read.low = dvec2(center[0], center[1]) - read.size_m * 0.5;
    }
    read.black = map.real("black", 0.0f, 1.0f, 0.0f);
    read.white = map.real("white", 0.0f, 1.0f, 1.0f);
    map.close();
    if (!map.document().sound()) return;
    if (!names.read_map) {
        map.report(ErrorId::file_missing, "picture", "no pictures are read here", "leave the map out");
        return;
    }
    auto picture = names.read_map(name, MapChannel(which));
    if (picture)
        read.picture = std::move(*picture);
    else
        map.report(picture.error().id, "picture",
                   fmt::format("'{}': {}{}{}", name, picture.error().place,
                               picture.error().place.empty() ? "" : ": ", picture.error().fault),
                   picture.error().remedy);
    if (read.picture) s.map = std::move(read);
}

void read_distance(JsonObject rule, const SceneNames& names, ScatterSettings& s) {
    std::vector<std::string> kinds;
    const nlohmann::json* from = rule.find("from");
    if (from && from->is_string()) kinds.push_back(from->get<std::string>());
    if (from && from->is_array())
        for (const auto& kind : *from)
            if (kind.is_string()) kinds.push_back(kind.get<std::string>());
    if (kinds.empty() || (from->is_array() && kinds.size() != from->size()))
        rule.report(ErrorId::syntax, "from", from ? "found " + shown(*from) : "missing",
                    "write a plant's name, or a list of names");
    for (const std::string& kind : kinds) names.find_kind(rule, "from", kind);
    constexpr double k_farthest_rule_m = 1e4;
    const bool apart = rule.has("least_m"), near = rule.has("most_m");
    const double least_m = apart ? rule.number("least_m", 0.001, k_farthest_rule_m) : 0.0;
    const double most_m = near ? rule.number("most_m", 0.001, k_farthest_rule_m) : INFINITY;
    if (!apart && !near)
        rule.report(ErrorId::syntax, "least_m", "neither least_m nor most_m", "write one of them, or both");
    if (least_m > most_m)
        rule.report(ErrorId::value_out_of_range, "most_m",
                    fmt::format("at least {:g} m and at most {:g} m", least_m, most_m),
                    "the larger distance as most_m");
    rule.close();
    if (!rule.document().sound()) return;
    std::vector<dvec2> places;
    for (const std::string& kind : kinds) {
        if (!names.places_of) break;
        auto more = names.places_of(kind);
        if (!more) {
            rule.report(more.error().id, "from", more.error().fault, more.error().remedy);
            return;
        }
        places.insert(places.end(), more->begin(), more->end());
    }
    DistanceRule read;
    if (apart) read.too_near = std::make_shared<NearPlaces>(places, least_m);
    if (near) read.near_enough = std::make_shared<NearPlaces>(places, most_m);
    s.distances.push_back(std::move(read));
}

// One rule, or a list.
void read_distances(JsonObject& object, const SceneNames& names, ScatterSettings& s) {
    if (!object.find("distance")->is_array()) return read_distance(object.object("distance"), names, s);
    for (JsonObject& rule : object.objects("distance")) read_distance(std::move(rule), names, s);
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
    if (object.has("density_map")) read_map(object.object("density_map"), names, s);
    if (object.has("distance")) read_distances(object, names, s);
    if (object.has("compete")) {
        JsonObject compete = object.object("compete");
        s.competition.crown_radius_m = compete.number("crown_radius_m", 0.001, 1000.0);
        s.competition.steps = uint32_t(compete.whole("steps", 0, k_competition_step_limit, 10));
        s.competition.growth = compete.number("growth", 0.0, 1.0, 0.1);
        s.competition.scale_most =
            compete.number("scale_most", double(k_scale_least), double(k_scale_most), 1.0);
        compete.close();
    }
    // Two scatters written alike must not put their plants on the same spots.
    s.seed = object.whole("seed", 0, UINT64_MAX, hash_text(object.place_of("seed")));
    object.close();
    return s;
}

}  // namespace coppice
