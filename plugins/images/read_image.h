// Pictures out of files and memory by OpenImageIO. Nothing is allocated before the header's sides, channels
// and tiles are checked; a decoded picture takes at most 512 MiB.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include "runtime/core/picture.h"

namespace coppice {

// Colour as stored, alpha not multiplied in. Grey becomes three equal channels, no alpha becomes 255.
// Errors: file_missing, file_unreadable, format_unknown, file_corrupt, limit_exceeded.
Result<Picture> read_image(const std::string& path);
// The format is found from the bytes, not from the name, which is for messages only.
Result<Picture> read_image_memory(std::span<const std::byte> bytes, const std::string& name);
Result<FloatPicture> read_float_image(const std::string& path);

}  // namespace coppice
