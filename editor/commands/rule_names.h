// What a rule may refer to beside plants and regions: pictures, and what stands already.
#pragma once
#include "editor/commands/target.h"

namespace coppice {

// names_of, with maps of density, and with the places of the file's plants: all that are placed one by one, listed or of a
// table, and those of rules before placement `before`, which grow for it. To be used while context and target are there.
// Errors: names_of's. A rule or table that is at fault has no plants.
Result<SceneNames> rule_names_of(const CommandContext& context, const Target& target, size_t before = SIZE_MAX);

}  // namespace coppice
