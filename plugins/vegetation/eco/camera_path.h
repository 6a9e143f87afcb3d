// Flights: keys in time, from a scene or from a file of their own. See README.md for the format.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

// {"keys": [...]}; keys given above the ground need its height; without a terrain they are above y = 0. Sorted by time, at least
// one. Errors: file_*, syntax, name_unknown, value_out_of_range.
Result<std::vector<CameraKey>> load_camera_path(const std::string& path, const GroundHeight& ground);
Result<std::vector<CameraKey>> load_camera_path(const std::string& path, const Terrain* terrain = nullptr);

// The list of keys inside a scene; faults go to the document.
std::vector<CameraKey> read_camera_keys(std::vector<JsonObject> keys, const GroundHeight& ground);

// What a scene's root says under "camera_path": keys, or the name of a file with them, relative to the folder; without
// any, one key at the origin.
Result<std::vector<CameraKey>> read_camera_path(JsonObject& root, const std::filesystem::path& folder,
                                                const GroundHeight& ground);

}  // namespace coppice
