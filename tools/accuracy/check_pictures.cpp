#include "tools/accuracy/check_pictures.h"

#include <cmath>
#include <string>

namespace coppice {
namespace {

bool whole(const FloatPicture& picture) {
    return picture.width > 0 && picture.height > 0 && picture.width <= k_picture_side_limit &&
           picture.height <= k_picture_side_limit &&
           picture.rgb.size() == size_t(picture.width) * picture.height * 3;
}

std::string size_of(const FloatPicture& picture) {
    return std::to_string(picture.width) + "x" + std::to_string(picture.height) + " with " +
           std::to_string(picture.rgb.size()) + " values";
}

}  // namespace

Status check_same_size(const FloatPicture& a, const FloatPicture& b) {
    if (whole(a) && whole(b) && a.width == b.width && a.height == b.height) return {};
    return fail(ErrorId::value_out_of_range, "", "", "pictures of " + size_of(a) + " and " + size_of(b),
                "two pictures of one size, sides from 1 to 16384, with all their values");
}

Status check_finite(std::span<const float> values, const char* what) {
    for (size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            return fail(ErrorId::value_out_of_range, "", std::string(what) + ", value " + std::to_string(i),
                        "a value that is not finite", "finite values");
    return {};
}

}  // namespace coppice
