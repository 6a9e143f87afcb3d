// Benchmarks that fly through scenes of content/: the whole path from the file to the picture.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// 640 pines at 795x700: above 30 Hz, and 30 times less time than the same frames with every triangle.
Result<nlohmann::json> bench_pines(const BenchSettings& settings);

// What the CPU does for a frame, by stage, for 100,000 plants whose tiles are all looked into, with d' as set and with a
// budget of the same size. Reach: under 1 ms in all.
Result<nlohmann::json> bench_frame(const BenchSettings& settings);

// The four scenes of Deussen et al. 2002, Table 1 (ERRATA 4), at 795x700: above 30 Hz each.
Result<nlohmann::json> bench_table(const BenchSettings& settings);

// 640, 5,000 and 50,000 trees at 1280x720, flown along the stand: a tenth of the time of what a user would
// pick instead. Reach: MEASURED's table, the fastest other program in each column, on two cores of one
// machine; compare with care elsewhere.
Result<nlohmann::json> bench_stand(const BenchSettings& settings);

}  // namespace coppice
