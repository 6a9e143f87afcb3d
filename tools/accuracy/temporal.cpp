// Errors that only show over time: metrics.h's PopEnergy and Shimmer.
#include <algorithm>
#include <cmath>
#include "tools/accuracy/check_pictures.h"
#include "tools/accuracy/metrics.h"

namespace coppice {
namespace {

uint32_t square_count(uint32_t side) { return (side + k_block_px - 1) / k_block_px; }

double square_of_difference(float a, float b) {
    const double difference = double(a) - double(b);
    return difference * difference;
}

Status check_sequence(uint32_t width, uint32_t height, const FloatPicture& next) {
    if (width == 0 || (next.width == width && next.height == height)) return {};
    return fail(ErrorId::value_out_of_range, "", "",
                "a picture of " + std::to_string(next.width) + "x" + std::to_string(next.height) +
                    " after one of " + std::to_string(width) + "x" + std::to_string(height),
                "one size all through");
}

}  // namespace

Status PopEnergy::add(const FloatPicture& before, const FloatPicture& after) {
    COPPICE_CHECK(check_same_size(before, after));
    COPPICE_CHECK(check_sequence(width_, height_, before));
    COPPICE_CHECK(check_finite(before.rgb, "the picture before"));
    COPPICE_CHECK(check_finite(after.rgb, "the picture after"));
    width_ = before.width;
    height_ = before.height;
    largest_.resize(size_t(square_count(width_)) * square_count(height_));
    auto largest = largest_.begin();
    for (uint32_t top = 0; top < height_; top += k_block_px)
        for (uint32_t left = 0; left < width_; left += k_block_px, ++largest) {
            const uint32_t bottom = std::min(top + k_block_px, height_),
                           right = std::min(left + k_block_px, width_);
            double sum = 0.0;
            for (uint32_t y = top; y < bottom; ++y)
                for (size_t i = (size_t(y) * width_ + left) * 3; i < (size_t(y) * width_ + right) * 3; ++i)
                    sum += square_of_difference(before.rgb[i], after.rgb[i]);
            *largest = std::max(*largest, sum / (3.0 * (bottom - top) * (right - left)));
        }
    return {};
}

double PopEnergy::energy() const {
    double sum = 0.0;
    auto largest = largest_.begin();
    for (uint32_t top = 0; top < height_; top += k_block_px)
        for (uint32_t left = 0; left < width_; left += k_block_px)
            sum += *largest++ * std::min(k_block_px, height_ - top) * std::min(k_block_px, width_ - left);
    return largest_.empty() ? 0.0 : sum / (double(width_) * height_);
}

Status Shimmer::add(const FloatPicture& frame) {
    COPPICE_CHECK(check_same_size(frame, frame));
    COPPICE_CHECK(check_sequence(last_.width, last_.height, frame));
    COPPICE_CHECK(check_finite(frame.rgb, "the frame"));
    if (last_.width > 0) {
        for (size_t i = 0; i < frame.rgb.size(); ++i)
            sum_ += square_of_difference(frame.rgb[i], last_.rgb[i]);
        count_ += frame.rgb.size();
    }
    last_ = frame;
    return {};
}

double Shimmer::rms() const { return count_ ? std::sqrt(sum_ / double(count_)) : 0.0; }

}  // namespace coppice
