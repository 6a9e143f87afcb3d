// The offline stage alone, on plants of content/species.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// Triangles a second of ordering and sampling an oak's leaves: above a million. Time of a whole cook of oak
// and pine, from the grown plant to the packed bytes, and whether one and two threads give the same bytes.
Result<nlohmann::json> bench_cook(const BenchSettings& settings);

}  // namespace coppice
