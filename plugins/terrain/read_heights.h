// Heights from the three formats that height maps come in and that need no library: PGM (P5, 8 or 16 bit),
// PFM (Pf, one channel of floats) and raw 16 bit little-endian. Rows from the top of the picture become rows
// from least z.
#pragma once
#include <string>
#include "plugins/terrain/height_field.h"
#include "runtime/core/result.h"

namespace coppice {

struct HeightFileSettings {
    float cell_m = 1.0f;
    float lowest_m = 0.0f, highest_m = 100.0f;  // of the integer formats: what 0 and the largest value mean
    uint32_t raw_columns = 0, raw_rows = 0;     // of .r16; 0: the file is square
};

// Errors: file_*, format_unknown, value_out_of_range (sides, NaN), limit_exceeded.
Result<HeightField> read_heights(const std::string& path, const HeightFileSettings& settings);

}  // namespace coppice
