// `coppice bench scale`: the same view and budget over scenes of 10^7 to 10^12 triangles.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"
#include "tools/coppice/bench.h"

namespace coppice {

// Makes the scenes (in the cache), flies over them in turns, writes a page into settings.out. Asked: the largest takes at
// most 1.2 times what that of 10^8 triangles does, and no more memory for tiles.
Result<nlohmann::json> bench_scale(const BenchSettings& settings);

}  // namespace coppice
