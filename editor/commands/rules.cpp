// Placements by rule, which a scene keeps as rules: "scatter" entries and the regions they use.
#include <fmt/format.h>
#include "editor/commands/brush.h"
#include "editor/commands/commands.h"
#include "editor/commands/rule_names.h"

namespace coppice {
namespace {

using Json = nlohmann::ordered_json;

// The text's "placements", made where there are none.
Json& placements_of(Json& json) {
    Json& placements = json["placements"];
    if (!placements.is_array()) placements = Json::array();
    return placements;
}

// Of a scatter; SIZE_MAX: reported.
size_t read_index(JsonObject& arguments, const Json& placements) {
    const uint64_t index = arguments.whole("index", 0, UINT32_MAX);
    if (index < placements.size() && placements[index].is_object() && placements[index].contains("scatter"))
        return index;
    arguments.report(ErrorId::value_out_of_range, "index", fmt::format("placement {} is no rule", index),
                     fmt::format("one of the {} placements that is a \"scatter\"", placements.size()));
    return SIZE_MAX;
}

// Checked as the scene's reader will.
void check_rule(JsonObject& arguments, SceneNames names, const Terrain* terrain) {
    names.places_of = nullptr;
    JsonObject rule = arguments.object("scatter");
    if (arguments.document().sound()) read_scatter(rule, names, terrain);
}

Json ordered(const nlohmann::json& value) { return Json::parse(value.dump()); }

}  // namespace

Result<Edit> make_add_rule(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, rule_names_of(context, target));
    check_rule(arguments, names, target.terrain);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Json json = target.file->text->json;
    placements_of(json).push_back({{"scatter", ordered(*arguments.find("scatter"))}});
    Edit edit = edit_text(target, std::move(json));
    edit.name = "add rule";
    return edit;
}

Result<Edit> make_set_rule(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, rule_names_of(context, target));
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, placements_of(json));
    check_rule(arguments, names, target.terrain);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    placements_of(json)[index]["scatter"] = ordered(*arguments.find("scatter"));
    Edit edit = edit_text(target, std::move(json));
    edit.name = fmt::format("change rule {}", index);
    return edit;
}

Result<Edit> make_remove_rule(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, placements_of(json));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    placements_of(json).erase(index);
    Edit edit = edit_text(target, std::move(json));
    edit.name = fmt::format("remove rule {}", index);
    return edit;
}

// The rule's plants as plants placed one by one, which a brush can erase and a hand can move.
Result<Edit> make_bake_rule(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    Json json = target.file->text->json;
    const size_t index = read_index(arguments, placements_of(json));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    COPPICE_TRY(const SceneNames names, rule_names_of(context, target, index));
    // Read where it stands, so that a rule without a seed has its own.
    COPPICE_TRY(JsonDocument rules, JsonDocument::parse(json.dump(), target.path));
    const std::string place = fmt::format("placements[{}].scatter", index);
    JsonObject rule(rules, rules.root().at("placements")[index].at("scatter"), place);
    const ScatterSettings settings = read_scatter(rule, names, target.terrain);
    COPPICE_CHECK(rules.status());
    COPPICE_TRY(const std::vector<Placement> grown, scatter(settings, target.path, place));
    std::vector<PlacedPlant> added;
    for (const Placement& plant : grown) added.push_back(placed_from(plant));
    placements_of(json).erase(index);
    Edit edit = edit_text(target, std::move(json));
    edit.files[0].after = with_placed(edit.files[0].after, target.path);
    edit.name = "place one by one " + count_text(context.document, added);
    edit.files[0].added = std::move(added);
    return edit;
}

// A region of that name, or none any more ("region": null).
Result<Edit> make_set_region(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    const std::string name = arguments.text("name");
    const nlohmann::json* region = arguments.find("region");
    if (!region)
        arguments.report(ErrorId::syntax, "region", "missing", "write a shape, a list of shapes, or null");
    else if (!region->is_null())
        read_region(arguments.document(), *region, arguments.place_of("region"));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Json json = target.file->text->json;
    Json& regions = json["regions"];
    if (!regions.is_object()) regions = Json::object();
    if (region->is_null())
        regions.erase(name);
    else
        regions[name] = ordered(*region);
    if (regions.empty()) json.erase("regions");
    Edit edit = edit_text(target, std::move(json));
    edit.name = (region->is_null() ? "remove region " : "set region ") + name;
    return edit;
}

}  // namespace coppice
