// What every metric asks of its pictures. All errors: value_out_of_range.
#pragma once
#include <span>
#include "runtime/core/picture.h"
#include "runtime/core/result.h"

namespace coppice {

// Not empty, all values there, of one size.
Status check_same_size(const FloatPicture& a, const FloatPicture& b);
// what: "the reference's coverage", for the message.
Status check_finite(std::span<const float> values, const char* what);

}  // namespace coppice
