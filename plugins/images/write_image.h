// Pictures into files: encoded in memory first, then written whole or not at all.
#pragma once
#include <cstddef>
#include <string>
#include <vector>
#include "runtime/core/picture.h"

namespace coppice {

// 8 bit, opaque: alpha is dropped. Errors: value_out_of_range (empty, or rgba of the wrong size),
// write_failed.
Result<std::vector<std::byte>> encode_png(const Picture& picture);
// *.png; *.ppm through the core. Another ending: usage.
Status write_image(const std::string& path, const Picture& picture);
// *.exr with 32-bit floats; *.pfm through the core. Another ending: usage.
Status write_float_image(const std::string& path, const FloatPicture& picture);

}  // namespace coppice
