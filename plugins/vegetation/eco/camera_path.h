// Flights: keys in time, from a scene or from a file of their own. See README.md for the format.
#pragma once
#include <string>
#include <vector>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

// {"keys": [...]}; keys given above the ground need the terrain, or are above y = 0. Sorted by time, at least
// one. Errors: file_*, syntax, name_unknown, value_out_of_range.
Result<std::vector<CameraKey>> load_camera_path(const std::string& path, const Terrain* terrain = nullptr);

// The list of keys inside a scene; faults go to the document.
std::vector<CameraKey> read_camera_keys(std::vector<JsonObject> keys, const Terrain* terrain);

}  // namespace coppice
