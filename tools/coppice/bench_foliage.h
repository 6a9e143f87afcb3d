// `coppice bench foliage`: what levels of detail of crowns cost with each structure, and what they keep of the crown.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// The trees of Rebollo et al. 2006, or the plant that settings.scene names; a page into settings.out. Errors: of the plant;
// value_out_of_range where it has no leaves.
Result<nlohmann::json> bench_foliage(const BenchSettings& settings);

}  // namespace coppice
