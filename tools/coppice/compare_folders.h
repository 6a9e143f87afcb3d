// Two reports of `coppice play --repeats`, flown earlier.
#pragma once
#include <string>
#include "runtime/core/result.h"
#include "tools/coppice/comparison.h"

namespace coppice {

// Each repeat's median frame is one sample; base against itself are its odd repeats against its even ones. Errors: the
// files' (file_*, syntax), usage: flown with other settings or too few repeats.
inline constexpr size_t k_least_repeats = 5;  // fewer can never be as rare as k_chance
Result<Comparison> compare_folders(const std::string& base, const std::string& changed, double floor_share);

}  // namespace coppice
