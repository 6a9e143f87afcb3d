#include "editor/commands/command.h"

#include <algorithm>
#include "editor/commands/commands.h"

namespace coppice {
namespace {

constexpr Command k_commands[] = {
    {"paint", make_paint},
    {"erase", make_erase},
    {"fill", make_fill},
    {"place", make_place},
    {"move", make_move},
    {"turn", make_turn},
    {"scale", make_scale},
    {"delete", make_delete},
    {"become", make_become},
    {"compete", make_compete},
    {"add_population", make_add_population},
    {"set_population", make_set_population},
    {"rename_population", make_rename_population},
    {"remove_population", make_remove_population},
    {"set_part", make_set_part},
    {"add_rule", make_add_rule},
    {"set_rule", make_set_rule},
    {"remove_rule", make_remove_rule},
    {"bake_rule", make_bake_rule},
    {"set_region", make_set_region},
    {"create_tile", make_create_tile},
    {"add_tile", make_add_tile},
    {"nest", make_nest},
    {"move_tile", make_move_tile},
    {"duplicate_tile", make_duplicate_tile},
    {"remove_tile", make_remove_tile},
    {"import_csv", make_import_csv},
    {"import_gltf", make_import_gltf},
};

// Those who plant where what stands there is not known would lose it.
Status check_plants(const Document& document, const Edit& edit) {
    for (const FileEdit& change : edit.files) {
        const EcoFile* file = document.find(change.path);
        if (file && file->is_made_up)
            return fail(ErrorId::usage, change.path, "", "a plant is open, and no scene",
                        "set_part, undo, redo and save; or open a scene, NAME.eco.json");
        if (file && file->plants_lost && !(change.removed.empty() && change.added.empty()))
            return fail(ErrorId::file_corrupt, file->placed_path, "",
                        "its plants could not be read, so none are placed beside them",
                        "bring the file back, from its .bak for instance, or move it away");
        if (file && file->plants.size() + change.added.size() > k_plant_limit)
            return fail(ErrorId::limit_exceeded, change.path, "",
                        "too many plants with those that stand there", "at most 20 million in a scene");
    }
    return {};
}

}  // namespace

std::span<const Command> all_commands() { return k_commands; }

Result<Edit> make_edit(const CommandContext& context, const std::string& name,
                       const nlohmann::json& arguments, const std::string& source, const std::string& place) {
    const auto command = std::find_if(std::begin(k_commands), std::end(k_commands),
                                      [&](const Command& known) { return name == known.name; });
    if (command == std::end(k_commands)) {
        std::vector<std::string> known;
        for (const Command& each : k_commands) known.push_back(each.name);
        return fail(ErrorId::name_unknown, source, place, "unknown command '" + name + "'",
                    known_names(name, known));
    }
    COPPICE_TRY(JsonDocument document, JsonDocument::parse("{}", source));
    JsonObject object(document, arguments, place);
    if (!document.sound()) return fail(document.status().error());
    Result<Edit> edit = command->make(context, object);
    COPPICE_CHECK(document.status());
    if (!edit) {
        Error error = edit.error();
        if (error.file.empty()) {
            error.file = source;
            error.place = error.place.empty() ? place : place + "." + error.place;
        }
        return fail(std::move(error));
    }
    COPPICE_CHECK(check_plants(context.document, *edit));
    if (edit->name.empty()) edit->name = name;
    return edit;
}

}  // namespace coppice
