// Everything that changes a document, by name: what the window's tools, scripts and tests call. A command looks at the
// document, changes nothing, and says what is to be changed. docs/editor.md lists the arguments.
#pragma once
#include <span>
#include <string>
#include "editor/document/document.h"
#include "plugins/shared/json_object.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/eco/density_map.h"

namespace coppice {

struct CommandContext {
    Document& document;                // gets names of kinds, and files that are referred to, but no edits
    const Terrain* terrain = nullptr;  // of the root; other files lie on a plane
    MapPictures* pictures = nullptr;   // null: rules have no density maps
};

// Faults of the arguments go to their document; the caller asks for its status first. Errors: also those of files that are
// read. An edit that changes nothing is empty.
using MakeEdit = Result<Edit> (*)(const CommandContext& context, JsonObject& arguments);

struct Command {
    const char* name;
    MakeEdit make;
};
std::span<const Command> all_commands();

// Finds the command and makes its edit. Same document, same arguments, same edit. Errors: name_unknown, with the nearest;
// of the arguments: syntax, value_out_of_range, name_unknown, limit_exceeded, with `place` before theirs.
Result<Edit> make_edit(const CommandContext& context, const std::string& name,
                       const nlohmann::json& arguments, const std::string& source, const std::string& place);

}  // namespace coppice
