// Counts the pixels that primitives cover together, by the same rules as the kernels in draw/: a pixel is
// covered when its centre lies inside. One thread at a time.
#pragma once
#include <cstdint>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

class CoverageRaster {
  public:
    explicit CoverageRaster(uint32_t side) : side_(int32_t(side)), stamps_(size_t(side) * side, 0) {}
    void begin() {
        ++stamp_;
        covered_ = 0;
    }
    void triangle(vec2 a, vec2 b, vec2 c);
    void square(vec2 center, float side);
    void line(vec2 a, vec2 b, float width);
    uint64_t covered() const { return covered_; }

  private:
    void cover(int32_t column, int32_t row) {
        uint32_t& stamp = stamps_[size_t(row) * size_t(side_) + size_t(column)];
        covered_ += stamp != stamp_;
        stamp = stamp_;
    }
    // First pixel whose centre is at or past x, within the picture.
    int32_t pixel(float x) const {
        return int32_t(std::ceil(std::fmin(std::fmax(x, 0.0f), float(side_)) - 0.5f));
    }

    int32_t side_;
    std::vector<uint32_t> stamps_;
    uint32_t stamp_ = 0;
    uint64_t covered_ = 0;
};

}  // namespace coppice
