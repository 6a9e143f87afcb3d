// From the "terrain" object of a scene to a Terrain. The object is described in README.md.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include "plugins/terrain/terrain.h"

namespace coppice {

// What TerrainInterface::load points to. Errors: syntax, name_unknown, value_out_of_range, limit_exceeded,
// file_*.
Result<std::shared_ptr<Terrain>> load_terrain(std::string_view json, const std::string& base_dir,
                                              const std::string& file);

}  // namespace coppice
