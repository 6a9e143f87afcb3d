// Scenes in scenes: tiles that stand where a reference puts them, and are scenes themselves.
#include <filesystem>
#include <set>
#include <fmt/format.h>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"

namespace coppice {
namespace {

using Json = nlohmann::ordered_json;

Json& references_of(Json& json) {
    Json& references = json["references"];
    if (!references.is_array()) references = Json::array();
    return references;
}

size_t read_index(JsonObject& arguments, const Json& references) {
    const uint64_t index = arguments.whole("index", 0, UINT32_MAX);
    if (index < references.size() && references[index].is_object()) return index;
    arguments.report(ErrorId::value_out_of_range, "index", fmt::format("there is no reference {}", index),
                     fmt::format("below {}", references.size()));
    return SIZE_MAX;
}

// "at", "turn_deg", "scale": only what is said changes.
void read_standing(JsonObject& arguments, Json& reference, bool needs_at) {
    if (needs_at || arguments.has("at")) {
        const auto at = arguments.numbers("at", 2, -k_farthest_m, k_farthest_m);
        reference["at"] = {at[0], at[1]};
    }
    if (arguments.has("turn_deg")) reference["turn_deg"] = arguments.number("turn_deg", -360.0, 360.0);
    if (arguments.has("scale"))
        reference["scale"] = arguments.number("scale", double(k_scale_least), double(k_scale_most));
}

// A new scene with the populations of the one that names it, their sources as seen from there.
Json new_scene(const EcoFile& parent, const std::string& parent_path, const std::string& path) {
    const std::filesystem::path from = std::filesystem::path(parent_path).parent_path();
    const std::filesystem::path to = std::filesystem::path(path).parent_path();
    Json scene = {{"plants", Json::object()}, {"placements", Json::array()}};
    const auto plants = parent.text->json.find("plants");
    if (plants == parent.text->json.end() || !plants->is_object()) return scene;
    for (const auto& [name, entry] : plants->items()) {
        Json copy = entry;
        if (copy.is_object() && copy.contains("source") && copy["source"].is_string()) {
            const std::filesystem::path source = copy["source"].get<std::string>();
            if (source.is_relative())
                copy["source"] =
                    (from / source).lexically_normal().lexically_relative(to.lexically_normal()).string();
        }
        scene["plants"][name] = std::move(copy);
    }
    return scene;
}

// Resolved; empty: reported.
std::string read_new_path(const CommandContext& context, JsonObject& arguments, const Target& target) {
    const std::string name = arguments.text("scene");
    if (!arguments.document().sound()) return {};
    const std::string path = Document::resolve(target.path, name);
    const EcoFile* known = context.document.find(path);
    std::error_code ignored;
    const bool taken = (known && known->text) || (!known && std::filesystem::exists(path, ignored));
    if (name.ends_with(".eco.json") && !taken) return path;
    arguments.report(ErrorId::value_out_of_range, "scene",
                     taken ? "'" + name + "' is there already" : "'" + name + "'",
                     "a new file that ends with .eco.json");
    return {};
}

// Each file once: what was opened may go in circles already.
bool leads_to(const Document& document, const std::string& from, const std::string& to) {
    std::vector<std::string> open{from};
    for (std::set<std::string> seen{from}; !open.empty();) {
        const std::string path = std::move(open.back());
        open.pop_back();
        if (path == to) return true;
        const EcoFile* file = document.find(path);
        if (!file || !file->text) continue;
        for (std::string& next : Document::references_of(path, *file->text))
            if (seen.insert(next).second) open.push_back(std::move(next));
    }
    return false;
}

Edit edit_references(const Target& target, Json json, std::string name) {
    if (references_of(json).empty()) json.erase("references");
    Edit edit = edit_text(target, std::move(json));
    edit.name = std::move(name);
    return edit;
}

}  // namespace

Result<Edit> make_create_tile(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    const std::string path = read_new_path(context, arguments, target);
    Json reference = {{"scene", arguments.text("scene")}};
    read_standing(arguments, reference, true);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Json json = target.file->text->json;
    references_of(json).push_back(reference);
    Edit edit =
        edit_references(target, std::move(json), "create tile " + reference["scene"].get<std::string>());
    edit.files.push_back(
        {path, nullptr, print_scene_text(new_scene(*target.file, target.path, path)), {}, {}});
    return edit;
}

// A scene that exists already.
Result<Edit> make_add_tile(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json reference = {{"scene", arguments.text("scene")}};
    read_standing(arguments, reference, true);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    const std::string path = Document::resolve(target.path, reference["scene"].get<std::string>());
    COPPICE_CHECK(context.document.read(path));
    if (leads_to(context.document, path, target.path)) {
        arguments.report(ErrorId::value_out_of_range, "scene", "it would come to stand in itself",
                         "a scene that does not refer to this one");
        return Edit{};
    }
    Json json = target.file->text->json;
    references_of(json).push_back(reference);
    return edit_references(target, std::move(json), "add tile " + reference["scene"].get<std::string>());
}

// Chosen plants go into a new scene that stands at "at".
Result<Edit> make_nest(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::vector<PlacedPlant> chosen = read_selection(arguments, context.document, *target.file, names);
    const std::string path = read_new_path(context, arguments, target);
    Json reference = {{"scene", arguments.text("scene")}};
    const auto at = arguments.numbers("at", 2, -k_farthest_m, k_farthest_m);
    reference["at"] = {at[0], at[1]};
    arguments.close();
    if (!arguments.document().sound() || chosen.empty()) return Edit{};
    std::vector<PlacedPlant> nested = chosen;
    const PlacedPlant origin = pack_placed({at[0], 0.0, at[1]}, 1.0f, {}, 0, 0);
    for (PlacedPlant& plant : nested) {
        plant.x = int32_t(std::clamp(int64_t(plant.x) - origin.x, int64_t(INT32_MIN), int64_t(INT32_MAX)));
        plant.z = int32_t(std::clamp(int64_t(plant.z) - origin.z, int64_t(INT32_MIN), int64_t(INT32_MAX)));
    }
    Json json = target.file->text->json;
    references_of(json).push_back(reference);
    Edit edit = edit_references(target, std::move(json), "nest " + count_text(context.document, chosen));
    edit.files[0].removed = chosen;
    const SceneTextPtr scene = print_scene_text(new_scene(*target.file, target.path, path));
    edit.files.push_back({path, nullptr, with_placed(scene, path), {}, std::move(nested)});
    return edit;
}

Result<Edit> make_move_tile(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, references_of(json));
    if (!arguments.document().sound()) return Edit{};
    read_standing(arguments, references_of(json)[index], false);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    return edit_references(target, std::move(json), fmt::format("move tile {}", index));
}

Result<Edit> make_duplicate_tile(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, references_of(json));
    if (!arguments.document().sound()) return Edit{};
    Json copy = references_of(json)[index];
    read_standing(arguments, copy, true);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    references_of(json).push_back(std::move(copy));
    return edit_references(target, std::move(json), fmt::format("duplicate tile {}", index));
}

// The reference alone: the tile's file stays.
Result<Edit> make_remove_tile(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, references_of(json));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    references_of(json).erase(index);
    return edit_references(target, std::move(json), fmt::format("remove tile {}", index));
}

}  // namespace coppice
