// What may be planted: the entries of "plants", and the plants that are placed of them.
#include <filesystem>
#include <fmt/format.h>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "plugins/vegetation/eco/measure_population.h"
#include "plugins/vegetation/eco/vary_color.h"

namespace coppice {
namespace {

using Json = nlohmann::ordered_json;

// What may be said of a population; only what is said changes.
void read_entry(JsonObject& arguments, Json& entry) {
    if (arguments.has("source")) entry["source"] = arguments.text("source");
    for (const char* key : {"variations", "individuals"})
        if (arguments.has(key)) entry[key] = arguments.whole(key, 1, k_individual_limit);
    if (arguments.has("height_m")) entry["height_m"] = arguments.number("height_m", 0.001, 1000.0);
    if (const auto* color = arguments.find("color_variation"); color && color->is_null()) {
        entry.erase("color_variation");
    } else if (color) {
        JsonObject object = arguments.object("color_variation");
        read_color_variation(object);
        entry["color_variation"] = Json::parse(color->dump());
    }
    if (arguments.has("importance")) entry["importance"] = arguments.number("importance", 0.001, 1000.0);
}

Json* find_entry(JsonObject& arguments, Json& json, const char* key, const std::string& name) {
    auto plants = json.find("plants");
    if (plants != json.end() && plants->is_object())
        if (auto entry = plants->find(name); entry != plants->end() && entry->is_object()) return &*entry;
    std::vector<std::string> known;
    if (plants != json.end() && plants->is_object())
        for (const auto& [each, ignored] : plants->items()) known.push_back(each);
    arguments.report(ErrorId::name_unknown, key, "unknown population '" + name + "'",
                     known_names(name, known));
    return nullptr;
}

bool is_free_name(JsonObject& arguments, const Json& json, const char* key, const std::string& name) {
    const auto plants = json.find("plants");
    const bool taken = plants != json.end() && plants->is_object() && plants->contains(name);
    if (!name.empty() && name.size() <= 200 && !taken) return true;
    arguments.report(ErrorId::value_out_of_range, key, taken ? "'" + name + "' is there already" : "no name",
                     "a name that no other population has");
    return false;
}

// "from" of one rule of distance, or of a list of them.
template <class Visit>
void visit_distance(Json& distance, Visit&& visit) {
    if (distance.is_array())
        for (Json& each : distance) visit_distance(each, visit);
    if (!distance.is_object() || !distance.contains("from")) return;
    Json& from = distance["from"];
    if (from.is_string()) visit(from);
    if (from.is_array())
        for (Json& name : from)
            if (name.is_string()) visit(name);
}

// Where placements name plants: calls visit(object, key) for each.
template <class Visit>
void each_use(Json& json, Visit&& visit) {
    auto placements = json.find("placements");
    if (placements == json.end() || !placements->is_array()) return;
    auto look = [&](Json& object) {
        if (auto plant = object.find("plant"); plant != object.end() && plant->is_string()) visit(*plant);
    };
    for (Json& placement : *placements) {
        if (!placement.is_object()) continue;
        look(placement);
        if (auto scatter = placement.find("scatter"); scatter != placement.end() && scatter->is_object()) {
            look(*scatter);
            if (auto shares = scatter->find("plants"); shares != scatter->end() && shares->is_object())
                visit(*shares);
            if (auto distance = scatter->find("distance"); distance != scatter->end())
                visit_distance(*distance, visit);
        }
        if (auto species = placement.find("species"); species != placement.end() && species->is_object())
            for (auto& [alias, name] : species->items())
                if (name.is_string()) visit(name);
    }
}

// The same object with one key called otherwise, in its place.
void rename_key(Json& object, const std::string& from, const std::string& to) {
    Json renamed = Json::object();
    for (auto& [key, value] : object.items()) renamed[key == from ? to : key] = value;
    object = std::move(renamed);
}

std::vector<PlacedPlant> plants_of(const EcoFile& file, uint16_t kind) {
    std::vector<PlacedPlant> plants;
    for (const auto& [cell, of_cell] : file.plants.cells())
        for (const PlacedPlant& plant : of_cell)
            if (plant.kind == kind) plants.push_back(plant);
    return plants;
}

}  // namespace

Result<Edit> make_add_population(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    const std::string name = arguments.text("name");
    arguments.text("source");
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    is_free_name(arguments, json, "name", name);
    Json entry = Json::object();
    read_entry(arguments, entry);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Json& plants = json["plants"];
    if (!plants.is_object()) plants = Json::object();
    plants[name] = std::move(entry);
    Edit edit = edit_text(target, std::move(json));
    edit.name = "add population " + name;
    return edit;
}

Result<Edit> make_set_population(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    const std::string name = arguments.text("name");
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    Json* entry = find_entry(arguments, json, "name", name);
    if (!entry) return Edit{};
    read_entry(arguments, *entry);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Edit edit = edit_text(target, std::move(json));
    edit.name = "change population " + name;
    return edit;
}

Result<Edit> make_rename_population(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    const std::string name = arguments.text("name"), to = arguments.text("to");
    arguments.close();
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    if (!find_entry(arguments, json, "name", name) || !is_free_name(arguments, json, "to", to)) return Edit{};
    rename_key(json["plants"], name, to);
    each_use(json, [&](Json& use) {
        if (use.is_object()) rename_key(use, name, to);
        if (use.is_string() && use.get<std::string>() == name) use = to;
    });
    std::vector<PlacedPlant> before = plants_of(*target.file, context.document.kind_of(name)), after = before;
    const uint16_t number = context.document.kind_of(to);
    for (PlacedPlant& plant : after) plant.kind = number;
    Edit edit = edit_text(target, std::move(json));
    edit.files[0].removed = std::move(before);
    edit.files[0].added = std::move(after);
    edit.name = "call " + name + " " + to;
    return edit;
}

// With its placed plants. What rules still ask for stays.
Result<Edit> make_remove_population(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    const std::string name = arguments.text("name");
    arguments.close();
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    if (!find_entry(arguments, json, "name", name)) return Edit{};
    bool used = false;
    each_use(json, [&](Json& use) {
        used |= use.is_object() ? use.contains(name) : use.get<std::string>() == name;
    });
    if (used) {
        arguments.report(ErrorId::value_out_of_range, "name",
                         "placements of the scene still ask for '" + name + "'",
                         "remove or change those first");
        return Edit{};
    }
    json["plants"].erase(name);
    Edit edit = edit_text(target, std::move(json));
    edit.files[0].removed = plants_of(*target.file, context.document.kind_of(name));
    edit.name = "remove population " + name;
    return edit;
}

}  // namespace coppice
