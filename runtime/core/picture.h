// A picture in memory, and the formats that need no library: PPM (8 bit sRGB), PFM (linear float), and PGM to read.
// The images plugin reads and writes the others where it is installed.
#pragma once
#include <cstdint>
#include <string>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

// rgba: 4 bytes a pixel, sRGB-encoded colour and linear alpha, rows from the top.
struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba;
    bool empty() const { return width == 0 || height == 0; }
};

// rgb: 3 floats a pixel, linear, rows from the top.
struct FloatPicture {
    uint32_t width = 0, height = 0;
    std::vector<float> rgb;
};

inline constexpr uint32_t k_picture_side_limit = 16384;

// Alpha is dropped. Errors: write_failed, value_out_of_range (empty, or rgba of the wrong size).
Status write_ppm(const std::string& path, const Picture& picture);
Result<Picture> read_ppm(const std::string& path);
// Not empty, all values there, of one size; else value_out_of_range.
Status check_same_size(const FloatPicture& a, const FloatPicture& b);

// PGM and PPM (P5, P6), 8 or 16 bit, as shares of the largest value, as stored; of a PGM all three channels are alike.
// Errors: format_unknown, value_out_of_range, file_truncated.
Result<FloatPicture> read_pnm(const std::string& path);

Status write_pfm(const std::string& path, const FloatPicture& picture);
Result<FloatPicture> read_pfm(const std::string& path);

}  // namespace coppice
