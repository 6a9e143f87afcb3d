// How far apart two pictures are, by OpenImageIO's own count.
#pragma once
#include "plugins/images/images.h"

namespace coppice {

// Errors: value_out_of_range (empty, not of one size, or rgb of the wrong size), limit_exceeded (no memory).
Result<PictureDifference> compare_images(const FloatPicture& a, const FloatPicture& b);

}  // namespace coppice
