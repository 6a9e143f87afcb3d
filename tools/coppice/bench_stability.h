// `coppice bench stability`: laws of the shadow maps' rows over every angle of light and view, as worst values.
#pragma once
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

Result<nlohmann::json> bench_stability();

}  // namespace coppice
