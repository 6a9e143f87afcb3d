// `coppice bench ecs`: what an entity costs, beside plain arrays measured in the same run.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

// 1 M, then 10 M entities of 32 bytes in three components, in tiles of 1,000: create and destroy, update,
// random access, memory. {"name": "ecs", "figures": [{name, value, unit, reach, holds}, ...]}. Medians of
// warm rounds in which both take turns. One thread, a few seconds, about 0.7 GB. Prints nothing. Error:
// limit_exceeded where memory is short.
Result<nlohmann::json> bench_ecs();

}  // namespace coppice
