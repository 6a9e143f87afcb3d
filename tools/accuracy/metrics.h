// How far one picture is from another. Pictures are in display light: linear, 1 is the brightest the screen can show,
// that is, after exposure and tone curve and before sRGB encoding (display_light()); all of the same size and finite,
// else value_out_of_range. No metric is NaN. Squares at the right and lower border are smaller; means over squares
// weigh each by its pixels.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/vegetation/components.h"
#include "runtime/core/picture.h"
#include "runtime/core/result.h"

namespace coppice {

// Radiance to display light, as draw/light.glsl's present() without the encoding. Negative or not a number: 0.
FloatPicture display_light(const FloatPicture& radiance, const Light& light);
// What is shown on a page: display light, sRGB-encoded.
Picture encode_srgb(const FloatPicture& display);
FloatPicture decode_srgb(const Picture& picture);

struct FrameErrors {
    double rmse = 0.0;     // root of the mean square over pixels and channels
    double psnr_db = 0.0;  // of a peak of 1; infinity where the pictures are equal
    double flip = 0.0;     // mean of the FLIP map, [0, 1]
    // Coverage: the share of a pixel that shows plants. Local: mean over squares of k_block_px pixels of the absolute
    // difference of the squares' means: noise of single pixels averages out, a crown too thin or a missing one does
    // not. Bias: of the whole picture, signed.
    double coverage = 0.0, coverage_bias = 0.0;
    // Distance of the mean colours, likewise: length of the difference over root 3, so that grey differs by its value
    // (a length: the bias has no sign here).
    double mean_color = 0.0, mean_color_bias = 0.0;
};
inline constexpr uint32_t k_block_px = 16;

struct MeasuredFrame {
    FloatPicture display;
    std::vector<float> coverage;  // a value a pixel, [0, 1]
};
// images: for RMSE and PSNR, which are OpenImageIO's. A module without compare(): name_unknown.
Result<FrameErrors> measure_errors(const MeasuredFrame& frame, const MeasuredFrame& reference,
                                   const ImagesInterface& images);

// Of a change of level of detail. before, after: the same view drawn with the level of the frame before and with its
// own, so that motion cancels; a sequence of such pairs is added one by one. Energy of a step at a place: mean square
// of the difference over a square of k_block_px pixels. A change that is spread over many steps has the same sum as one
// that comes at once, and is not seen; so what counts at each place is the largest step.
class PopEnergy {
  public:
    Status add(const FloatPicture& before, const FloatPicture& after);
    // Mean over the places of their largest step; 0 before the first pair.
    double energy() const;

  private:
    uint32_t width_ = 0, height_ = 0;
    std::vector<double> largest_;
};

// RMS difference of consecutive frames of a static scene under a slow camera.
class Shimmer {
  public:
    Status add(const FloatPicture& frame);
    double rms() const;  // 0 before the second frame

  private:
    FloatPicture last_;
    double sum_ = 0.0;
    uint64_t count_ = 0;
};

}  // namespace coppice
