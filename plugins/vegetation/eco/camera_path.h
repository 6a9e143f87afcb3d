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

// Such a file's text: load_camera_path gives the keys back, up to the rounding of angles from radians to degrees. Requires
// what it asks for: at most k_key_limit keys, times that grow.
std::string camera_path_text(const std::vector<CameraKey>& keys);
inline constexpr size_t k_key_limit = 100000;

// The list of keys inside a scene; faults go to the document.
std::vector<CameraKey> read_camera_keys(std::vector<JsonObject> keys, const GroundHeight& ground);

// What a scene's root says under "camera_path": keys, or the name of a file with them, relative to the folder; without
// any, one key at the origin.
Result<std::vector<CameraKey>> read_camera_path(JsonObject& root, const std::filesystem::path& folder,
                                                const GroundHeight& ground);

}  // namespace coppice
