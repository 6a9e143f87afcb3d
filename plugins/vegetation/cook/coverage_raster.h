// Counts the pixels in which each part of a plant is seen, by the same rules as the kernels in draw/: a pixel is covered when
// its centre lies inside, and the nearest shows. One thread at a time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

class CoverageRaster {
  public:
    explicit CoverageRaster(uint32_t side, uint32_t part_count = 1)
        : side_(int32_t(side)), pixels_(size_t(side) * side), seen_(part_count) {}
    void begin() {
        ++stamp_;
        std::fill(seen_.begin(), seen_.end(), 0);
    }
    // Of what follows; < part_count.
    void set_part(uint32_t part) { part_ = part; }
    // x, y: pixels; z: distance, of any unit.
    void triangle(vec3 a, vec3 b, vec3 c);
    void square(vec3 center, float side);
    void line(vec3 a, vec3 b, float width);
    // Pixels that show each part.
    std::span<const uint64_t> seen() const { return seen_; }
    uint64_t covered() const { return std::accumulate(seen_.begin(), seen_.end(), uint64_t(0)); }

  private:
    struct Pixel {
        uint32_t stamp = 0, part = 0;
        float distance = 0.0f;
    };
    void cover(int32_t column, int32_t row, float distance) {
        Pixel& pixel = pixels_[size_t(row) * size_t(side_) + size_t(column)];
        if (pixel.stamp == stamp_) {
            if (!(distance < pixel.distance)) return;
            --seen_[pixel.part];
        }
        ++seen_[part_];
        pixel = {stamp_, part_, distance};
    }
    // First pixel whose centre is at or past x, within the picture.
    int32_t pixel(float x) const {
        return int32_t(std::ceil(std::fmin(std::fmax(x, 0.0f), float(side_)) - 0.5f));
    }

    int32_t side_;
    std::vector<Pixel> pixels_;
    std::vector<uint64_t> seen_;
    uint32_t stamp_ = 0, part_ = 0;
};

}  // namespace coppice
