#include "plugins/images/compare_images.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <limits>

namespace coppice {
namespace {

// The picture's own memory, which comparing only reads.
OIIO::ImageBuf view_of(const FloatPicture& picture) {
    OIIO::ImageSpec spec(int(picture.width), int(picture.height), 3, OIIO::TypeDesc::FLOAT);
    return {spec, const_cast<float*>(picture.rgb.data())};
}

}  // namespace

Result<PictureDifference> compare_images(const FloatPicture& a, const FloatPicture& b) {
    COPPICE_CHECK(check_same_size(a, b));
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
