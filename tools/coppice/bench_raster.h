// `coppice bench raster`: primitives a second of the rasteriser alone, for points, lines and triangles of given size.
#pragma once
#include <string>
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

// {"name": "raster", "device": ..., "figures": [{name, value, unit, reach, holds}]}. Errors: device_missing, ...
Result<nlohmann::json> bench_raster(const std::string& device_choice);

}  // namespace coppice
