// `coppice bench accuracy`: every method's time against its error.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// Leaves index.html, accuracy.json, accuracy.csv and pictures in settings.out. Errors: name_unknown (a method),
// value_out_of_range (a scene without plants), usage (a size), those of the scene.
Result<nlohmann::json> bench_accuracy(const BenchSettings& settings);

}  // namespace coppice
