// From radiance to what a screen shows: metrics.h's display_light(); sRGB and back.
#include <algorithm>
#include <array>
#include "plugins/vegetation/components.h"
#include "runtime/core/jobs.h"
#include "runtime/core/math.h"
#include "tools/accuracy/metrics.h"

namespace coppice {
namespace {

constexpr size_t k_grain = size_t(1) << 15;  // values

// The curve passes 1 at 7.25 already; without a limit the squares of huge values would give inf / inf.
constexpr float k_white_radiance = 100.0f;

// light.glsl's present() up to the encoding. Not a number: black.
float tone_curve(float radiance) {
    float c = radiance > 0.0f ? std::min(radiance, k_white_radiance) : 0.0f;
    return std::min(c * (2.51f * c + 0.03f) / (c * (2.43f * c + 0.59f) + 0.14f), 1.0f);
}

}  // namespace

FloatPicture display_light(const FloatPicture& radiance, const Light& light) {
    FloatPicture display{radiance.width, radiance.height, std::vector<float>(radiance.rgb.size())};
    parallel_for(radiance.rgb.size(), k_grain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) display.rgb[i] = tone_curve(radiance.rgb[i] * light.exposure);
    });
    return display;
}

Picture encode_srgb(const FloatPicture& display) {
    const size_t pixels = display.rgb.size() / 3;
    Picture picture{display.width, display.height, std::vector<uint8_t>(pixels * 4, 255)};
    parallel_for(pixels, k_grain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            for (size_t c = 0; c < 3; ++c)
                picture.rgba[i * 4 + c] = uint8_t(linear_to_srgb(display.rgb[i * 3 + c]) * 255.0f + 0.5f);
    });
    return picture;
}

FloatPicture decode_srgb(const Picture& picture) {
    std::array<float, 256> linear;
    for (size_t i = 0; i < linear.size(); ++i) linear[i] = srgb_to_linear(float(i) / 255.0f);
    FloatPicture display{picture.width, picture.height, std::vector<float>(picture.rgba.size() / 4 * 3)};
    for (size_t i = 0; i < display.rgb.size(); ++i) display.rgb[i] = linear[picture.rgba[i / 3 * 4 + i % 3]];
    return display;
}

}  // namespace coppice
