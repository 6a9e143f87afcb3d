// What every metric asks of its pictures. All errors: value_out_of_range.
#pragma once
#include <span>
#include "runtime/core/picture.h"
#include "runtime/core/result.h"

namespace coppice {

// what: "the reference's coverage", for the message.
Status check_finite(std::span<const float> values, const char* what);

}  // namespace coppice
