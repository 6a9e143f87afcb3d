#include "tools/coppice/play_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include "runtime/core/picture.h"

namespace coppice {
namespace {

// The whole of text as a number, or false.
template <class Number>
bool parse_number(std::string_view text, Number& number) {
    auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

}  // namespace

Status parse_size(const char* option, const std::string& text, uint32_t& width, uint32_t& height) {
    size_t cross = text.find('x');
    std::string_view view = text;
    if (cross == std::string::npos || !parse_number(view.substr(0, cross), width) ||
        !parse_number(view.substr(cross + 1), height) || width == 0 || height == 0 ||
        width > k_picture_side_limit || height > k_picture_side_limit)
        return fail(ErrorId::usage, "", option, fmt::format("'{}' is not a picture size", text),
                    "write WIDTHxHEIGHT, each from 1 to 16384, as in 1280x720");
    return {};
}

Result<vec2> parse_sun(const std::string& text) {
    const size_t comma = std::min(text.find(','), text.size());
    const std::string_view view = text, second = view.substr(std::min(comma + 1, text.size()));
    vec2 sun_deg(0.0f);
    if (!parse_number(view.substr(0, comma), sun_deg.x) || !parse_number(second, sun_deg.y) ||
        !(std::fabs(sun_deg.x) <= 360.0f) || !(std::fabs(sun_deg.y) <= 90.0f))
        return fail(ErrorId::usage, "", "--sun", fmt::format("'{}' is not where a sun stands", text),
                    "write AZIMUTH,ELEVATION in degrees, as in 135,20");
    return sun_deg;
}

std::vector<uint32_t> spread_frames(uint32_t count, uint32_t frame_count) {
    std::vector<uint32_t> frames;
    count = std::min(count, frame_count);
    for (uint32_t i = 0; i < count; ++i)
        frames.push_back(count == 1 ? 0 : uint32_t(uint64_t(i) * (frame_count - 1) / (count - 1)));
    return frames;
}

Result<std::vector<uint32_t>> chosen_frames(const std::string& text, uint32_t frame_count) {
    std::vector<uint32_t> frames;
    uint32_t number = 0;
    if (parse_number(text, number)) return spread_frames(number, frame_count);
    for (size_t first = 0; first <= text.size();) {
        size_t comma = std::min(text.find(',', first), text.size());
        std::string_view piece = std::string_view(text).substr(first, comma - first);
        if (!piece.empty() && !parse_number(piece, number))
            return fail(ErrorId::usage, "", "--pictures", fmt::format("'{}' is not a frame number", piece),
                        "write frames as in 0,30,60 or how many pictures, as in 4");
        if (!piece.empty() && number < frame_count) frames.push_back(number);
        first = comma + 1;
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

}  // namespace coppice
