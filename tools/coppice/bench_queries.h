// `coppice bench queries`: what a game asks of a million stems, on one core.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

// A million stems 7 m apart, put off their places by chance: rays, the nearest, boxes, edits. {"name": "queries", "figures":
// [{name, value, unit, reach, holds}, ...]}. Times are of the thread's own work on the processor, so that other programs
// count little; the best of several rounds. A few seconds, about 200 MB. Prints nothing.
Result<nlohmann::json> bench_queries();

}  // namespace coppice
