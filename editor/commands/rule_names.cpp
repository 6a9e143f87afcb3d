#include "editor/commands/rule_names.h"

#include <fmt/format.h>
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/place_named.h"
#include "plugins/vegetation/eco/read_placements_csv.h"

namespace coppice {
namespace {

class Standing {
  public:
    Standing(Document& document, const Target& target, SceneNames names)
        : document_(document), target_(target), names_(std::move(names)) {}

    std::vector<dvec2> places_of(const std::string& kind, size_t before) {
        const uint16_t number = document_.kind_of(kind);
        std::vector<dvec2> places;
        for (const auto& [cell, plants] : target_.file->plants.cells())
            for (const PlacedPlant& plant : plants)
                if (plant.kind == number) places.push_back(ground_place(plant));
        const auto& json = target_.file->text->json;
        const auto placements = json.find("placements");
        if (placements == json.end() || !placements->is_array()) return places;
        for (size_t i = 0; i < placements->size(); ++i) {
            if ((i >= before && (*placements)[i].contains("scatter")) || !names_kind((*placements)[i], kind)) continue;
            for (const Placement& plant : plants_of(i))
                if (plant.model.model >> 16 == number)
                    places.emplace_back(plant.position_world.x, plant.position_world.z);
        }
        return places;
    }

  private:
    // Not the others: a scene may have rules of millions of plants.
    static bool names_kind(const nlohmann::ordered_json& placement, const std::string& kind) {
        if (!placement.is_object()) return false;
        if (placement.contains("csv") || placement.contains("gltf")) return true;
        const auto scatter = placement.find("scatter");
        const auto& named = scatter != placement.end() ? *scatter : placement;
        if (!named.is_object()) return false;
        const auto plant = named.find("plant"), shares = named.find("plants");
        return (plant != named.end() && *plant == kind) ||
               (shares != named.end() && shares->is_object() && shares->contains(kind));
    }

    const std::vector<Placement>& plants_of(size_t i) {
        const auto [known, is_new] = grown_.try_emplace(i);
        // Only rules before it are asked for while it grows: none waits for itself.
        if (is_new) known->second = read(i).value_or(std::vector<Placement>());
        return known->second;
    }

    Result<std::vector<Placement>> read(size_t i) {
        const std::string place = fmt::format("placements[{}]", i);
        const auto& placement = target_.file->text->json.at("placements")[i];
        COPPICE_TRY(JsonDocument json, JsonDocument::parse(placement.dump(), target_.path));
        JsonObject entry(json, json.root(), place);
        if (entry.has("csv")) return read_table(entry);
        if (entry.has("gltf")) return read_nodes(entry);
        if (entry.has("plant")) {
            const auto& at = json.root().value("at", nlohmann::json::array());
            if (!at.is_array() || at.size() < 2 || !at.front().is_number() || !at.back().is_number())
                return std::vector<Placement>();
            Placement plant{};
            plant.position_world = {at.front().get<double>(), 0.0, at.back().get<double>()};
            plant.model.model = model_of(document_.kind_of(entry.text("plant")), 0);
            return std::vector{plant};
        }
        JsonObject rule = entry.object("scatter");
        COPPICE_CHECK(json.status());
        SceneNames names = names_;
        names.places_of = [this, i](const std::string& kind) -> Result<std::vector<dvec2>> {
            return places_of(kind, i);
        };
        const ScatterSettings settings = read_scatter(rule, names, target_.terrain);
        COPPICE_CHECK(json.status());
        return scatter(settings, target_.path, place);
    }

    Result<std::vector<Placement>> read_table(JsonObject& entry) const {
        CsvSettings settings;
        const auto offset = entry.numbers("offset", 2, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                          std::vector<double>{0.0, 0.0});
        settings.offset = {offset[0], offset[1]};
        settings.kinds = kinds_of(entry);
        return read_placements_csv(Document::resolve(target_.path, entry.text("csv")), settings);
    }

    Result<std::vector<Placement>> read_nodes(JsonObject& entry) const {
        const std::string path = Document::resolve(target_.path, entry.text("gltf"));
        const auto offset = entry.numbers("offset", 3, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                          std::vector<double>{0.0, 0.0, 0.0});
        COPPICE_TRY(const std::vector<NamedPlaces> named, read_named_places(path));
        return place_named(named, {kinds_of(entry), dvec3(offset[0], offset[1], offset[2]), 1}, path);
    }

    std::map<std::string, PlantKind> kinds_of(JsonObject& entry) const {
        std::map<std::string, PlantKind> kinds = names_.kinds;
        if (const nlohmann::json* species = entry.find("species"); species && species->is_object())
            for (const auto& [alias, name] : species->items())
                if (auto kind = names_.kinds.find(name.is_string() ? name.get<std::string>() : "");
                    kind != names_.kinds.end())
                    kinds[alias] = kind->second;
        return kinds;
    }

    Document& document_;
    Target target_;
    SceneNames names_;
    std::map<size_t, std::vector<Placement>> grown_;
};

}  // namespace

Result<SceneNames> rule_names_of(const CommandContext& context, const Target& target, size_t before) {
    COPPICE_TRY(SceneNames names, names_of(context.document, *target.file, target.path));
    if (context.pictures)
        names.read_map = [pictures = context.pictures, path = target.path](const std::string& name, MapChannel channel) {
            return pictures->read(Document::resolve(path, name), channel);
        };
    auto standing = std::make_shared<Standing>(context.document, target, names);
    names.places_of = [standing, before](const std::string& kind) -> Result<std::vector<dvec2>> {
        return standing->places_of(kind, before);
    };
    return names;
}

}  // namespace coppice
