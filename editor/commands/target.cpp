#include "editor/commands/target.h"

#include <fmt/format.h>
#include "plugins/vegetation/eco/measure_population.h"

namespace coppice {

Target read_target(const CommandContext& context, JsonObject& arguments) {
    Document& document = context.document;
    Target target{document.root_path(), nullptr, nullptr};
    const std::string name = arguments.text("file", "");
    if (!name.empty()) target.path = Document::resolve(document.root_path(), name);
    if (target.path == document.root_path()) target.terrain = context.terrain;
    target.file = document.find(target.path);
    if (target.file && target.file->text) return target;
    target.file = nullptr;
    arguments.report(ErrorId::name_unknown, "file", fmt::format("'{}' is not part of this scene", name),
                     "a file that the scene refers to, relative to it");
    return target;
}

Result<SceneNames> names_of(Document& document, const EcoFile& file, const std::string& path) {
    COPPICE_TRY(JsonDocument json, JsonDocument::parse(file.text->text, path));
    SceneNames names;
    JsonObject root(json, json.root(), "");
    if (const nlohmann::json* plants = root.find("plants"); plants && plants->is_object()) {
        JsonObject entries = root.object("plants");
        for (const auto& [name, ignored] : plants->items()) {
            JsonObject entry = entries.object(name.c_str());
            const uint64_t variations = entry.whole("variations", 1, k_individual_limit, 1);
            const uint64_t individuals =
                entry.whole("individuals", variations, k_individual_limit, variations);
            PlantKind kind;
            kind.height_m = entry.real("height_m", 0.001f, 1000.0f, 0.0f);
            kind.individuals.clear();
            const uint16_t number = document.kind_of(name);
            for (uint32_t i = 0; i < individuals; ++i)
                kind.individuals.push_back({model_of(number, i), 1.0f});
            names.kinds[name] = std::move(kind);
        }
    }
    if (const nlohmann::json* regions = root.find("regions"); regions && regions->is_object())
        for (const auto& [name, value] : regions->items())
            names.regions[name] = read_region(json, value, "regions." + name);
    COPPICE_CHECK(json.status());
    return names;
}

PlacedPlant placed_from(const Placement& plant, double lift_m) {
    const dvec3& at = plant.position_world;
    return pack_placed({at.x, lift_m, at.z}, plant.scale, plant.turn, uint16_t(plant.model.model >> 16),
                       uint16_t(plant.model.model));
}

std::vector<uint16_t> read_populations(JsonObject& arguments, const Document& document, const EcoFile& file,
                                       const SceneNames& names) {
    std::vector<uint16_t> kinds;
    const nlohmann::json* list = arguments.find("populations");
    if (!list) return kinds;
    if (!list->is_array() || list->empty()) {
        arguments.report(ErrorId::syntax, "populations", "found " + shown(*list), "write [\"name\", ...]");
        return kinds;
    }
    std::vector<std::string> known;
    for (const auto& [name, kind] : names.kinds) known.push_back(name);
    std::vector<bool> placed(document.kinds().size(), false);
    for (const auto& [cell, plants] : file.plants.cells())
        for (const PlacedPlant& plant : plants) placed[plant.kind] = true;
    for (const auto& item : *list) {
        const std::string name = item.is_string() ? item.get<std::string>() : shown(item);
        const auto number = std::find(document.kinds().begin(), document.kinds().end(), name);
        const bool found = number != document.kinds().end() &&
                           (names.kinds.contains(name) || placed[size_t(number - document.kinds().begin())]);
        if (!found)
            arguments.report(ErrorId::name_unknown, "populations",
                             fmt::format("unknown population '{}'", name), known_names(name, known));
        else
            kinds.push_back(uint16_t(number - document.kinds().begin()));
    }
    std::sort(kinds.begin(), kinds.end());
    return kinds;
}

std::vector<PlacedPlant> read_selection(JsonObject& arguments, const Document& document, const EcoFile& file,
                                        const SceneNames& names) {
    std::vector<PlacedPlant> chosen;
    const std::vector<uint16_t> kinds = read_populations(arguments, document, file, names);
    const nlohmann::json* region_value = arguments.find("region");
    if (arguments.has("near")) {
        const auto at = arguments.numbers("near", 2, -k_farthest_m, k_farthest_m);
        const double radius_m = arguments.number("radius_m", 0.0, 1e5, 2.0);
        if (region_value)
            arguments.report(ErrorId::syntax, "region", "both near and region", "write one of them");
        const dvec2 middle(at[0], at[1]);
        double nearest_m = radius_m;
        file.plants.each_in(middle - radius_m, middle + radius_m, [&](const PlacedPlant& plant) {
            const double away_m = glm::length(ground_place(plant) - middle);
            // Of equally near ones the last in order.
            if (away_m > nearest_m || !is_chosen(kinds, plant.kind)) return;
            nearest_m = away_m;
            chosen.assign(1, plant);
        });
        return chosen;
    }
    Region region;
    if (region_value)
        region =
            read_region(arguments.document(), *region_value, arguments.place_of("region"), names.regions);
    if (!arguments.document().sound()) return chosen;
    auto add = [&](const PlacedPlant& plant) {
        if (is_chosen(kinds, plant.kind) && (!region_value || region.contains(ground_place(plant))))
            chosen.push_back(plant);
    };
    if (region_value) {
        const auto [low, high] = region.bounds();
        file.plants.each_in(low, high, add);
    } else {
        for (const auto& [cell, plants] : file.plants.cells())
            for (const PlacedPlant& plant : plants) add(plant);
    }
    return chosen;
}

Edit edit_of(const Target& target, std::vector<PlacedPlant> removed, std::vector<PlacedPlant> added) {
    const SceneTextPtr& before = target.file->text;
    if (removed.empty() && added.empty()) return {};
    return {"",
            {{target.path, before, with_placed(before, target.path), std::move(removed), std::move(added)}}};
}

Edit edit_text(const Target& target, nlohmann::ordered_json json) {
    if (json == target.file->text->json) return {};
    return {"", {{target.path, target.file->text, print_scene_text(std::move(json)), {}, {}}}};
}

std::string count_text(const Document& document, std::span<const PlacedPlant> plants) {
    if (plants.empty()) return "nothing";
    for (const PlacedPlant& plant : plants)
        if (plant.kind != plants.front().kind) return fmt::format("{} plants", plants.size());
    return fmt::format("{} {}", plants.size(), document.kinds()[plants.front().kind]);
}

}  // namespace coppice
