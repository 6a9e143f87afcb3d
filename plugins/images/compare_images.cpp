#include "plugins/images/compare_images.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <limits>

namespace coppice {
namespace {

bool whole(const FloatPicture& picture) {
    return picture.width > 0 && picture.height > 0 && picture.width <= k_picture_side_limit &&
           picture.height <= k_picture_side_limit &&
           picture.rgb.size() == size_t(picture.width) * picture.height * 3;
}

std::string text_of(const FloatPicture& picture) {
    return std::to_string(picture.width) + "x" + std::to_string(picture.height) + " with " +
           std::to_string(picture.rgb.size()) + " values";
}

// The picture's own memory, which comparing only reads.
OIIO::ImageBuf view_of(const FloatPicture& picture) {
    OIIO::ImageSpec spec(int(picture.width), int(picture.height), 3, OIIO::TypeDesc::FLOAT);
    return {spec, const_cast<float*>(picture.rgb.data())};
}

}  // namespace

Result<PictureDifference> compare_images(const FloatPicture& a, const FloatPicture& b) {
    if (!whole(a) || !whole(b) || a.width != b.width || a.height != b.height)
        return fail(ErrorId::value_out_of_range, "", "",
                    "pictures of " + text_of(a) + " and of " + text_of(b) + " do not compare",
                    "two pictures of one size, sides from 1 to 16384, with all their values");
    auto failed = [](const std::string& why) {
        return fail(ErrorId::limit_exceeded, "", "", "OpenImageIO cannot compare: " + why,
                    "smaller pictures");
    };
    try {
        const OIIO::ImageBuf first = view_of(a), second = view_of(b);
        // Only the sums count here, so nothing is a failure or worth a warning.
        constexpr float never = std::numeric_limits<float>::max();
        const auto found = OIIO::ImageBufAlgo::compare(first, second, never, never, OIIO::ROI(), 1);
        if (found.error) return failed(first.geterror());
        return PictureDifference{found.meanerror, found.maxerror, found.rms_error, found.PSNR};
    } catch (const std::exception& thrown) {
        return failed(thrown.what());
    } catch (...) {
        return failed("unknown exception");
    }
}

}  // namespace coppice
