// What a scene says about other scenes that stand in it.
#pragma once
#include <filesystem>
#include <vector>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/scene_file.h"

namespace coppice {

// Faults go to the document. folder: what the paths are relative to.
std::vector<SceneReference> read_references(std::vector<JsonObject> entries,
                                            const std::filesystem::path& folder);

}  // namespace coppice
