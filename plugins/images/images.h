// Interface "coppice.images": pictures in the formats of OpenImageIO. Loaded on demand; where the module is not
// installed, PPM and PFM of runtime/core/picture.h remain.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include "runtime/core/picture.h"

namespace coppice {

inline constexpr const char* k_images_interface = "coppice.images";
inline constexpr uint32_t k_images_version = 1;

// Over all pixels and channels alike.
struct PictureDifference {
    double mean = 0.0, largest = 0.0;  // absolute
    double rms = 0.0;                  // root of the mean square
    double psnr_db =
        0.0;  // of a peak of 1, or of the largest value in either where that is more; equal: infinity
};

struct ImagesInterface {
    uint32_t size_bytes;
    // Any format OpenImageIO reads; sides at most k_picture_side_limit. Colour as stored (sRGB for PNG and JPEG).
    Result<Picture> (*read)(const std::string& path);
    // bytes: a whole PNG or JPEG file; name: for messages.
    Result<Picture> (*read_memory)(std::span<const std::byte> bytes, const std::string& name);
    // PNG (8 bit, opaque) by the ending of the path; replaces the file whole or not at all.
    Status (*write)(const std::string& path, const Picture& picture);
    // PNG file in memory.
    Result<std::vector<std::byte>> (*encode_png)(const Picture& picture);
    Result<FloatPicture> (*read_float)(const std::string& path);  // EXR, PFM, ... linear
    Status (*write_float)(const std::string& path, const FloatPicture& picture);
    // Empty or of two sizes: value_out_of_range. Where size_bytes ends before it, the module is older.
    Result<PictureDifference> (*compare)(const FloatPicture& a, const FloatPicture& b);
};

}  // namespace coppice
