// What a plant's parts turn into in the distance and how important they are, kept beside the plant.
#include <filesystem>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "plugins/vegetation/cook/part_settings.h"

namespace coppice {
namespace {

using Json = nlohmann::ordered_json;

// Of the population's plant; empty: reported.
std::string read_plant_path(JsonObject& arguments, const Target& target) {
    const std::string name = arguments.text("population");
    if (!target.file) return {};
    const Json& json = target.file->text->json;
    const auto plants = json.find("plants");
    std::vector<std::string> known;
    if (plants != json.end() && plants->is_object())
        for (const auto& [each, entry] : plants->items()) {
            if (each == name && entry.is_object() && entry.contains("source") && entry["source"].is_string())
                return Document::resolve(target.path, entry["source"].get<std::string>());
            known.push_back(each);
        }
    arguments.report(ErrorId::name_unknown, "population", "unknown population '" + name + "'",
                     known_names(name, known));
    return {};
}

}  // namespace

// Only what is said changes; what is as it would be without settings is not written.
Result<Edit> make_set_part(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    const std::string plant = read_plant_path(arguments, target), part = arguments.text("part");
    Json changed = Json::object();
    if (arguments.has("kind")) changed["kind"] = arguments.text("kind");
    if (arguments.has("importance"))
        changed["importance"] = arguments.number("importance", 0.0, double(k_importance_limit));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    if (plant.ends_with(".plant"))
        return fail(ErrorId::value_out_of_range, plant, "", "is packed: its parts are what they were cooked to",
                    "name the species or model that it was cooked from");
    const std::string path = part_settings_path(plant);
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) COPPICE_CHECK(context.document.read(path));
    const EcoFile* file = context.document.find(path);
    const SceneTextPtr before = file ? file->text : nullptr;
    Json json = before ? before->json : Json::object();
    Json& parts = json["parts"];
    if (!parts.is_object()) parts = Json::object();
    Json& entry = parts[part];
    if (!entry.is_object()) entry = Json::object();
    entry.update(changed);
    if (entry.value("kind", Json("automatic")) == "automatic") entry.erase("kind");
    if (entry.value("importance", Json(0.0)) == 0.0) entry.erase("importance");
    if (entry.empty()) parts.erase(part);
    // It is checked as the cook will.
    SceneTextPtr after = print_scene_text(std::move(json));
    if (auto settings = parse_part_settings(after->text, path); !settings) return fail(settings.error());
    if (!before && parse_part_settings(after->text, path)->empty()) return Edit{};
    if (before && before->json == after->json) return Edit{};
    Edit edit;
    edit.name = "set " + std::filesystem::path(plant).stem().string() + ": " + part;
    edit.files.push_back({path, before, std::move(after), {}, {}});
    return edit;
}

}  // namespace coppice
