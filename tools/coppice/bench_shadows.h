// `coppice bench shadows`: what each kind of shadow map costs, and how steadily it stands.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// Over the scenes of Table 1 (Deussen et al. 2002), or settings.scene.
Result<nlohmann::json> bench_shadows(const BenchSettings& settings);

}  // namespace coppice
