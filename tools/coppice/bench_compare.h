// Whether `coppice compare` can be trusted on this machine: slowdowns put in on purpose are found, a program passes
// against itself.
#pragma once
#include "tools/coppice/bench.h"

namespace coppice {

// settings.comparisons of each kind. Errors: compare_programs'.
Result<nlohmann::json> bench_compare(const BenchSettings& settings);

}  // namespace coppice
