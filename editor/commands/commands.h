// The commands behind the names; what each takes is in docs/editor.md.
#pragma once
#include "editor/commands/command.h"

namespace coppice {

// paint.cpp
Result<Edit> make_paint(const CommandContext&, JsonObject&);
Result<Edit> make_erase(const CommandContext&, JsonObject&);
Result<Edit> make_fill(const CommandContext&, JsonObject&);
// single.cpp
Result<Edit> make_place(const CommandContext&, JsonObject&);
Result<Edit> make_move(const CommandContext&, JsonObject&);
Result<Edit> make_turn(const CommandContext&, JsonObject&);
Result<Edit> make_scale(const CommandContext&, JsonObject&);
Result<Edit> make_delete(const CommandContext&, JsonObject&);
Result<Edit> make_become(const CommandContext&, JsonObject&);
// compete.cpp
Result<Edit> make_compete(const CommandContext&, JsonObject&);
// populations.cpp
Result<Edit> make_add_population(const CommandContext&, JsonObject&);
Result<Edit> make_set_population(const CommandContext&, JsonObject&);
Result<Edit> make_rename_population(const CommandContext&, JsonObject&);
Result<Edit> make_remove_population(const CommandContext&, JsonObject&);
Result<Edit> make_set_part(const CommandContext&, JsonObject&);
// rules.cpp
Result<Edit> make_add_rule(const CommandContext&, JsonObject&);
Result<Edit> make_set_rule(const CommandContext&, JsonObject&);
Result<Edit> make_remove_rule(const CommandContext&, JsonObject&);
Result<Edit> make_bake_rule(const CommandContext&, JsonObject&);
Result<Edit> make_set_region(const CommandContext&, JsonObject&);
// tiles.cpp
Result<Edit> make_create_tile(const CommandContext&, JsonObject&);
Result<Edit> make_add_tile(const CommandContext&, JsonObject&);
Result<Edit> make_nest(const CommandContext&, JsonObject&);
Result<Edit> make_move_tile(const CommandContext&, JsonObject&);
Result<Edit> make_duplicate_tile(const CommandContext&, JsonObject&);
Result<Edit> make_remove_tile(const CommandContext&, JsonObject&);
// exchange.cpp
Result<Edit> make_import_csv(const CommandContext&, JsonObject&);
Result<Edit> make_import_gltf(const CommandContext&, JsonObject&);

}  // namespace coppice
