#include "tools/accuracy/metrics.h"

#include <algorithm>
#include <cmath>
#include "runtime/core/math.h"
#include "tools/accuracy/check_pictures.h"
#include "tools/accuracy/flip.h"

namespace coppice {
namespace {

Status check_frames(const MeasuredFrame& frame, const MeasuredFrame& reference) {
    COPPICE_CHECK(check_same_size(frame.display, reference.display));
    const size_t pixels = size_t(frame.display.width) * frame.display.height;
    for (const MeasuredFrame* measured : {&frame, &reference})
        if (measured->coverage.size() != pixels)
            return fail(ErrorId::value_out_of_range, "", measured == &frame ? "the frame" : "the reference",
                        std::to_string(measured->coverage.size()) + " values of coverage for " +
                            std::to_string(pixels) + " pixels",
                        "a value a pixel");
    COPPICE_CHECK(check_finite(frame.display.rgb, "the frame"));
    COPPICE_CHECK(check_finite(reference.display.rgb, "the reference"));
    COPPICE_CHECK(check_finite(frame.coverage, "the frame's coverage"));
    return check_finite(reference.coverage, "the reference's coverage");
}

// A square's share of the error is weighted by its pixels, so the absolute sums need no division of their own.
void measure_squares(const MeasuredFrame& frame, const MeasuredFrame& reference, FrameErrors& errors) {
    const uint32_t width = frame.display.width, height = frame.display.height;
    const double pixels = double(width) * height;
    double coverage_sum = 0.0;
    dvec3 color_sum(0.0);
    for (uint32_t top = 0; top < height; top += k_block_px)
        for (uint32_t left = 0; left < width; left += k_block_px) {
            double coverage = 0.0;
            dvec3 color(0.0);
            for (uint32_t y = top; y < std::min(top + k_block_px, height); ++y)
                for (uint32_t x = left; x < std::min(left + k_block_px, width); ++x) {
                    const size_t i = size_t(y) * width + x;
                    coverage += double(frame.coverage[i]) - double(reference.coverage[i]);
                    for (size_t c = 0; c < 3; ++c)
                        color[int(c)] +=
                            double(frame.display.rgb[i * 3 + c]) - double(reference.display.rgb[i * 3 + c]);
                }
            errors.coverage += std::abs(coverage) / pixels;
            errors.mean_color += glm::length(color) / pixels;
            coverage_sum += coverage;
            color_sum += color;
        }
    errors.coverage_bias = coverage_sum / pixels;
    errors.mean_color /= std::sqrt(3.0);
    errors.mean_color_bias = glm::length(color_sum) / pixels / std::sqrt(3.0);
}

}  // namespace

Result<FrameErrors> measure_errors(const MeasuredFrame& frame, const MeasuredFrame& reference,
                                   const ImagesInterface& images) {
    COPPICE_CHECK(check_frames(frame, reference));
    if (images.size_bytes < sizeof(ImagesInterface))
        return fail(ErrorId::name_unknown, "", "plugin images", "it does not compare pictures",
                    "the module that was built with this program");
    FrameErrors errors;
    COPPICE_TRY(const PictureDifference difference, images.compare(frame.display, reference.display));
    errors.rmse = difference.rms;
    errors.psnr_db = difference.psnr_db;
    COPPICE_TRY(const std::vector<float> map, flip_map(frame.display, reference.display));
    double sum = 0.0;
    for (float value : map) sum += double(value);
    errors.flip = sum / double(map.size());
    measure_squares(frame, reference, errors);
    return errors;
}

}  // namespace coppice
